#pragma once

#include "config/channel/channel_keys.hpp"
#include "config/document/document.hpp"
#include "core/model/channel_spec.hpp"
#include "core/protocol/protocol.hpp"

namespace fieldcast::config {

struct ChannelContext {
  // Null if unknown; checks that depend on it are skipped.
  const Protocol* protocol = nullptr;
  ChannelDefaults defaults;
  std::uint16_t max_block = 0;
};

// Adds all faults; with faults the result is incomplete.
[[nodiscard]] ChannelSpec read_channel(const Node& node, const ChannelContext& context,
                                       FaultList& faults);

// "float32", "string(20)"; parses only the type, not the rest of the encoding.
struct TypeRule {
  std::optional<Encoding> operator()(const Node& node, std::string_view key,
                                     FaultList& faults) const;
  [[nodiscard]] std::string schema() const;
  [[nodiscard]] std::string form() const;
};

}  // namespace fieldcast::config
