// The options of a connection: servers, TLS, login, reconnection.
#pragma once

#include <string>
#include <tl/expected.hpp>

#include "tools/forward/outlet/nats/jetstream_spec.hpp"
#include "tools/forward/outlet/nats/nats_handles.hpp"

namespace fieldcast::forward {

// Reads the files of the login. Fails with one line with the file, without secrets.
[[nodiscard]] tl::expected<NatsOptions, std::string> nats_options(const JetStreamSpec& spec,
                                                                  const std::string& name);

// The URL of the connected server, without its login; "?" if there is none.
[[nodiscard]] std::string server_of(natsConnection* connection);
// The last error of the connection.
[[nodiscard]] std::string reason_of(natsConnection* connection);

}  // namespace fieldcast::forward
