// The keys of a connection to NATS JetStream, for every program that has one.
#pragma once

#include <string>
#include <vector>

#include "config/document/map_reader.hpp"
#include "config/files/library.hpp"
#include "tools/forward/outlet/nats/jetstream_spec.hpp"

namespace fieldcast::forward {

// Servers, TLS and login.
[[nodiscard]] std::vector<config::Field<JetStreamSpec>> connection_fields();
// Names of streams and buckets. `remark` is appended to the text of a stream.
[[nodiscard]] std::vector<config::Field<JetStreamSpec>> stream_name_fields(
    const std::string& remark);

// Reads the keys that the rows do not read, and checks all of both tables. REQUIRES: the rows of
// `map` were read into `spec`.
void read_connection(config::MapReader& map, JetStreamSpec& spec, config::Library& library);

}  // namespace fieldcast::forward
