// Which protocol a bus or a device speaks: one that is built in, or one that a file declares.
#pragma once

#include <map>
#include <string>
#include <string_view>

#include "config/library.hpp"
#include "core/protocol/declared/declaration.hpp"
#include "core/protocol/registry.hpp"

namespace fieldcast::config {

// What one load shares.
struct LoadState {
  FaultList& faults;
  Library& library;
  // By their document; nothing: faulty.
  std::map<const Node*, declared::SharedDeclaration> declarations{};
  std::size_t channels = 0;  // of the whole bridge, as far as it was read
};

struct ProtocolChoice {
  std::string name;                         // empty: unknown
  const ProtocolEntry* built_in = nullptr;  // one of these two
  declared::SharedDeclaration declaration;
  [[nodiscard]] bool known() const { return built_in != nullptr || declaration; }
};

// Built-in names come first; other words are files in protocols/ beside the configuration, then
// those that come with Fieldcast. What is neither is a fault with the nearest name; a declaration
// with faults notes them and leaves the choice unknown.
[[nodiscard]] ProtocolChoice read_protocol(const Node& node, std::string_view key,
                                           LoadState& state);

}  // namespace fieldcast::config
