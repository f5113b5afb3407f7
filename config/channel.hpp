// One channel: its keys, its type, and the rules that hold between them.
#pragma once

#include "config/cascade.hpp"
#include "config/document.hpp"
#include "config/fault_list.hpp"
#include "core/model/spec.hpp"
#include "core/protocol/protocol.hpp"

namespace fieldcast::config {

struct ChannelContext {
  // Nothing: it is unknown, and what depends on it stays unchecked.
  const Protocol* protocol = nullptr;
  ChannelDefaults defaults;
  std::uint16_t max_block = 0;
};

// Faults are noted; with faults the result is whatever could be read, so that a load finds all of
// them.
[[nodiscard]] ChannelSpec read_channel(const Node& node, const ChannelContext& context,
                                       FaultList& faults);

// "float32", "string(20)"; understands the type only, leaves the rest of the encoding.
struct TypeRule {
  std::optional<Encoding> operator()(const Node& node, std::string_view key,
                                     FaultList& faults) const;
  [[nodiscard]] std::string schema() const;
  [[nodiscard]] std::string form() const;
};

}  // namespace fieldcast::config
