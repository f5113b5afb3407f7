#include "tools/forward/settings/jetstream_keys.hpp"

#include <utility>

#include "tools/forward/settings/connection_keys.hpp"

namespace fieldcast::forward {
namespace {

using config::field;
using config::MapReader;
using config::Node;
using config::Rows;

constexpr Duration kLeastWait = std::chrono::milliseconds{100};
constexpr Duration kMostWait = std::chrono::minutes{5};
constexpr Duration kMostDuplicates = std::chrono::hours{24 * 7};

const Rows<StreamSpec>& stream_rows() {
  static const Rows<StreamSpec> rows(
      "streams", "'streams'",
      {
          field<StreamSpec>({.name = "create",
                             .fallback = "`false`",
                             .text = "creates the streams and the buckets if they are missing; "
                                     "existing ones are not changed"},
                            &StreamSpec::create, config::FlagRule{}),
          field<StreamSpec>({.name = "replicas",
                             .fallback = "`1`",
                             .text = "servers that store each message; 3 in a cluster"},
                            &StreamSpec::replicas, config::WholeRule{1, 5}),
          field<StreamSpec>({.name = "keep",
                             .fallback = "`forever`",
                             .text = "how long the streams keep a message"},
                            &StreamSpec::keep, config::KeepRule{}),
          field<StreamSpec>({.name = "duplicates",
                             .fallback = "`10min`",
                             .text = "how long the server recognises a repeated message"},
                            &StreamSpec::duplicates,
                            config::DurationRule{std::chrono::seconds{1}, kMostDuplicates}),
      });
  return rows;
}

std::vector<config::Field<JetStreamSpec>> jetstream_fields() {
  std::vector<config::Field<JetStreamSpec>> fields = connection_fields();
  fields.push_back(field<JetStreamSpec>(
      {.name = "acknowledgement",
       .fallback = "`5s`",
       .text = "a message without an acknowledgement in this time is sent "
               "again"},
      &JetStreamSpec::acknowledgement, config::DurationRule{kLeastWait, kMostWait}));
  for (auto& each : stream_name_fields(", if it is created")) fields.push_back(std::move(each));
  fields.push_back(field<JetStreamSpec>({.name = "audit-stream",
                                         .fallback = "`FIELDCAST_AUDIT`",
                                         .text = "the name, if it is created"},
                                        &JetStreamSpec::audit_stream, config::NameRule{}));
  fields.push_back({{.name = "streams",
                     .fallback = "used, not created",
                     .text = "how missing streams are created",
                     .schema = "{}"}});
  return fields;
}

const Rows<JetStreamSpec>& jetstream_rows() {
  static const Rows<JetStreamSpec> rows("jetstream", "'jetstream'", jetstream_fields());
  return rows;
}

}  // namespace

OutletSpec read_jetstream(MapReader& file, const Node& section, config::Library& library) {
  JetStreamSpec spec;
  MapReader map(section, jetstream_rows(), file.faults());
  jetstream_rows().read(map, spec);
  read_connection(map, spec, library);
  stream_rows().read_section(map, "streams", spec.streams);
  return spec;
}

void document_jetstream(const AddKeys& add) {
  add("jetstream.", jetstream_rows());
  add("jetstream.streams.", stream_rows());
}

}  // namespace fieldcast::forward
