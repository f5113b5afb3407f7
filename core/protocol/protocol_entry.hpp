// A request of another master in unsolicited bytes; used by core/bus/wire/wire_fence.hpp. Any
// thread.
#pragma once

#include <cstddef>
#include <memory>
#include <optional>
#include <span>
#include <string_view>
#include <tl/expected.hpp>

#include "core/base/bytes.hpp"
#include "core/frame/line.hpp"
#include "core/protocol/protocol.hpp"

namespace fieldcast {

struct SeenRequest {
  std::size_t size = 0;  // characters; 0 if none
  // False if a device's response can look the same.
  bool certain = true;
  [[nodiscard]] explicit operator bool() const { return size > 0; }
};

// Matches a whole request to any device, with a valid check, at the beginning of the bytes.
using RequestMatcher = SeenRequest (*)(ByteView bytes);

// Size of the whole frame at the beginning of a stream; 0: not yet whole; empty: not a frame.
using Framer = std::optional<std::size_t> (*)(ByteView stream);

// The row of a built-in protocol: names, options, limits of its lines, and the functions that make
// it and explain its frames. families/registry.hpp lists all rows. Constant data, any thread.
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
  // Null if several requests cannot be in flight: its responses do not identify their requests.
  Framer first_frame = nullptr;
  bool network_only = false;  // frames its own stream, so no serial line carries it
  bool stream_only = false;   // its frames are not datagrams, or only with `datagram_option`
  std::string_view datagram_option{};  // needs a port of UDP
  bool whole_bytes = false;            // needs 8 data bits
  std::string_view instead{};          // protocol to use if one of these two rules is broken
  bool one_device = false;             // a device has its own line
  bool carrier_checks = false;         // its frames have no check of their own
  // Wireshark's own dissector; empty: that of share/wireshark/fieldcast.lua.
  std::string_view dissector{};
  std::span<const ProtocolAlias> aliases{};
  std::span<const ProtocolVariant> variants{};  // the first one has no options, if possible
};

}  // namespace fieldcast
