// A protocol named by the user: built in, a declaration's path, or an installed one's name.
#pragma once

#include <iosfwd>
#include <optional>
#include <string>
#include <string_view>

#include "core/protocol/declared/declaration.hpp"
#include "core/protocol/families/registry.hpp"

namespace fieldcast::cli {

inline constexpr const char* kProtocolHelp =
    "modbus-rtu, omron-hostlink, .., or a declaration: instrument, ./mine.yaml";

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
