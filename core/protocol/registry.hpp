// The protocols that are built in, one row for each. The loader, the JSON Schema, the documents,
// `fieldcast inspect`, the simulator's check and the fuzz targets read these rows: no other file
// names a protocol in order to treat it in its own way.
//
// Constant data, any thread.
#pragma once

#include <span>
#include <string_view>
#include <tl/expected.hpp>

#include "core/frame/line.hpp"
#include "core/protocol/protocol.hpp"
#include "core/protocol/seen_request.hpp"

namespace fieldcast {

struct ProtocolOption {
  std::string_view name, value;
};

// One choice of options that changes a protocol's frames or its addresses.
struct ProtocolVariant {
  std::span<const ProtocolOption> options{};
  std::span<const std::string_view> addresses{};  // one example or more of each form of address
};

// What users write who mean this protocol: "rtu".
struct ProtocolAlias {
  std::string_view alias;
  std::string_view hint{};  // what to write instead, where the protocol's name alone is not enough
};

struct ProtocolEntry {
  using Maker = tl::expected<std::unique_ptr<Protocol>, OptionFault> (*)(const DeviceLink& link);

  std::string_view name;     // "modbus-rtu"
  std::string_view summary;  // one line for people
  Maker make = nullptr;
  Explainer explain = nullptr;
  RequestMatcher seen_request =
      nullptr;  // nullptr: no line, on which another master could be heard
  std::span<const std::string_view> options{};  // the names that `make` understands
  std::string_view options_text{};              // what they do, for config/README.md
  LineFormat factory_line{};                    // of its devices as they come from the factory
  bool network_only = false;    // it frames its own stream: no serial line carries it
  bool whole_bytes = false;     // it needs 8 data bits
  std::string_view instead{};   // the protocol that fits where one of these two rules is broken
  bool one_device = false;      // a device has its line for itself
  bool carrier_checks = false;  // its frames have no check of their own
  // Of Wireshark itself; empty: the one of share/wireshark/fieldcast.lua.
  std::string_view dissector{};
  std::span<const ProtocolAlias> aliases{};
  std::span<const ProtocolVariant> variants{};  // the first one is without options, if it can be
};

// In the order in which they are listed for people.
[[nodiscard]] std::span<const ProtocolEntry> protocols();
[[nodiscard]] const ProtocolEntry* find_protocol(std::string_view name);

// The link of a device at `address` with the variant's options.
[[nodiscard]] DeviceLink link_of(const ProtocolVariant& variant, std::uint16_t address);

}  // namespace fieldcast
