// Derives types and error codes from the notation of an address. Topics do not contain the
// protocol: the channels of the device limit the possible built-in families. If these differ, the
// user must give the type. Pure.
#pragma once

#include <cstdint>
#include <iosfwd>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <tl/expected.hpp>

#include "core/protocol/declared/declaration.hpp"
#include "core/protocol/families/registry.hpp"
#include "core/protocol/protocol.hpp"

namespace fieldcast::cli {

// Default type at an address (core/model/fit.hpp): "bool" for coil:16. `said` has priority.
[[nodiscard]] tl::expected<std::string, std::string> type_at(std::string_view at,
                                                             const std::string& said,
                                                             const Protocol& protocol);

struct KnownChannel {
  std::string at, type;
};
// For an unknown protocol. An address of no built-in family is uint16 (declared protocol).
[[nodiscard]] tl::expected<std::string, std::string> type_at(
    std::string_view at, const std::string& said, std::span<const KnownChannel> channels);

// Text of a device error for such an address: "02 illegal data address", or "code 5A".
[[nodiscard]] std::string device_code_at(std::string_view at, std::uint16_t code);

inline constexpr const char* kProtocolHelp =
    "modbus-rtu, omron-hostlink, .., or a declaration: instrument, ./mine.yaml";

// A protocol named by the user: built in, a declaration's path, or an installed one's name.
struct NamedProtocol {
  const ProtocolEntry* built_in = nullptr;  // null: declared
  declared::SharedDeclaration declaration;
  [[nodiscard]] std::string_view name() const {
    return built_in != nullptr ? built_in->name : std::string_view(declaration.value->name);
  }
  [[nodiscard]] LineFormat factory_line() const {
    return built_in != nullptr ? built_in->factory_line : LineFormat{};
  }
};

// Prints faults to `err`; `command` is for example "inspect".
[[nodiscard]] std::optional<NamedProtocol> named_protocol(const std::string& name,
                                                          std::string_view command,
                                                          std::ostream& err);

}  // namespace fieldcast::cli
