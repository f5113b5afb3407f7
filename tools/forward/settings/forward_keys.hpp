// The rows of all keys of the configuration.
#pragma once

#include "config/document/map_reader.hpp"
#include "tools/forward/settings/configuration.hpp"

namespace fieldcast::forward {

inline constexpr std::size_t kMostServers = 16;

// The map `jetstream` configures the outlet and the sender.
struct JetStreamKeys {
  JetStreamSpec outlet;
  SendSpec send;
};

[[nodiscard]] const config::Rows<ForwardSpec>& forward_rows();
[[nodiscard]] const config::Rows<QueueSpec>& queue_rows();
[[nodiscard]] const config::Rows<GatherSpec>& gather_rows();
[[nodiscard]] const config::Rows<PayloadSpec>& payload_rows();
[[nodiscard]] const config::Rows<JetStreamKeys>& jetstream_rows();
[[nodiscard]] const config::Rows<StreamSpec>& stream_rows();

}  // namespace fieldcast::forward
