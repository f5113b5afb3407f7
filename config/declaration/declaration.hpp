// Parses a declared protocol; see config/protocols/README.md for the format.
#pragma once

#include <map>
#include <string>
#include <string_view>

#include "config/document/document.hpp"
#include "config/files/library.hpp"
#include "core/protocol/declared/declaration.hpp"
#include "core/protocol/families/registry.hpp"

namespace fieldcast::config {

// Null after a fault; adds all faults.
[[nodiscard]] declared::SharedDeclaration read_declaration(const Node& root,
                                                           const std::string& name,
                                                           FaultList& faults);

struct LoadState {
  FaultList& faults;
  Library& library;
  // By document; null if invalid.
  std::map<const Node*, declared::SharedDeclaration> declarations{};
  std::size_t channels = 0;  // of the whole bridge so far
  // The value of `calculate` of each calculated channel so far; null if it is not a text.
  std::vector<const Node*> calculations{};
};

struct ProtocolChoice {
  std::string name;                         // empty if unknown
  const ProtocolEntry* built_in = nullptr;  // either this or `declaration` is set
  declared::SharedDeclaration declaration;
  [[nodiscard]] bool known() const { return built_in != nullptr || declaration; }
};

// Searches the built-in protocols, protocols/ beside the configuration, then those supplied. Adds a
// fault with the nearest name if it finds none. An invalid declaration returns an unknown choice.
[[nodiscard]] ProtocolChoice read_protocol(const Node& node, std::string_view key,
                                           LoadState& state);

}  // namespace fieldcast::config
