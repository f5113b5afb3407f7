// The rows of all keys of the configuration.
#pragma once

#include "config/document/map_reader.hpp"
#include "tools/forward/settings/configuration.hpp"

namespace fieldcast::forward {

[[nodiscard]] const config::Rows<ForwardSpec>& forward_rows();
[[nodiscard]] const config::Rows<QueueSpec>& queue_rows();
[[nodiscard]] const config::Rows<GatherSpec>& gather_rows();
[[nodiscard]] const config::Rows<PayloadSpec>& payload_rows();
[[nodiscard]] const config::Rows<SendSpec>& send_rows();

}  // namespace fieldcast::forward
