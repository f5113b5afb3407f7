// Creates the streams and the bucket of a site's messages if they are missing.
#pragma once

#include <string>
#include <tl/expected.hpp>

#include "tools/forward/outlet/nats/jetstream_spec.hpp"
#include "tools/forward/outlet/nats/nats_handles.hpp"

namespace fieldcast::forward {

// Does not change an existing stream. Fails with one line that names the stream. Blocks until the
// server has responded, at most 5 s for each stream.
[[nodiscard]] tl::expected<void, std::string> create_streams(jsCtx& context,
                                                             const JetStreamSpec& spec);

}  // namespace fieldcast::forward
