// The built-in protocols, one row each. The loader, the JSON Schema, the documents, `fieldcast
// inspect`, the simulator's check and the fuzz targets read these rows: no other file treats a
// protocol by its name. Constant data, any thread.
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

// Options that change a protocol's frames or addresses.
struct ProtocolVariant {
  std::span<const ProtocolOption> options{};
  std::span<const std::string_view> addresses{};  // at least one example of each form of address
};

// Another name that users write for this protocol: "rtu".
struct ProtocolAlias {
  std::string_view alias;
  std::string_view hint{};  // text to write instead, if the protocol's name alone is not enough
};

struct ProtocolEntry {
  using Maker = tl::expected<std::unique_ptr<Protocol>, OptionFault> (*)(const DeviceLink& link);

  std::string_view name;
  std::string_view summary;  // one human-readable line
  Maker make = nullptr;
  Explainer explain = nullptr;
  RequestMatcher seen_request =
      nullptr;  // null if there is no line on which another master could be heard
  std::span<const std::string_view> options{};  // names supported by `make`
  std::string_view options_text{};              // their description, for config/README.md
  LineFormat factory_line{};                    // factory setting of the devices
  bool network_only = false;    // frames its own stream, so no serial line carries it
  bool whole_bytes = false;     // needs 8 data bits
  std::string_view instead{};   // protocol to use if one of these two rules is broken
  bool one_device = false;      // a device has its own line
  bool carrier_checks = false;  // its frames have no check of their own
  // Wireshark's own dissector; empty: that of share/wireshark/fieldcast.lua.
  std::string_view dissector{};
  std::span<const ProtocolAlias> aliases{};
  std::span<const ProtocolVariant> variants{};  // the first one has no options, if possible
};

// In the order of human-readable lists.
[[nodiscard]] std::span<const ProtocolEntry> protocols();
[[nodiscard]] const ProtocolEntry* find_protocol(std::string_view name);

[[nodiscard]] DeviceLink link_of(const ProtocolVariant& variant, std::uint16_t address);

}  // namespace fieldcast
