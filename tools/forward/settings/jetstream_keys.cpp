#include "tools/forward/settings/jetstream_keys.hpp"

#include <fmt/format.h>

#include "config/document/limits.hpp"
#include "config/document/scalars.hpp"
#include "tools/forward/settings/login_keys.hpp"
#include "tools/forward/settings/server_address.hpp"

namespace fieldcast::forward {
namespace {

using config::field;
using config::MapReader;
using config::Node;
using config::Rows;

constexpr std::size_t kMostServers = 16;
constexpr Duration kLeastWait = std::chrono::milliseconds{100};
constexpr Duration kMostWait = std::chrono::minutes{5};
constexpr Duration kMostDuplicates = std::chrono::hours{24 * 7};
constexpr std::string_view kServerForm = "nats://HOST:PORT or tls://HOST:PORT";

void read_servers(MapReader& map, JetStreamSpec& spec) {
  const Node* node = map.find("servers");
  if (node == nullptr) return;
  if (!config::is_list(*node, "servers", 1, kMostServers,
                       fmt::format("a list of 1 to {}, each {}", kMostServers, kServerForm),
                       map.faults(), config::as_list(*node)))
    return;
  spec.servers.clear();
  for (const Node* item : node->items) {
    const std::string* text = config::scalar_of(*item, "server", kServerForm, map.faults());
    if (text == nullptr) continue;
    const auto address = server_address_from(*text);
    if (!address) {
      map.faults().add(item->position, address.error(), kServerForm);
      continue;
    }
    if (!address->tls && !address->on_loopback && !spec.without_tls) {
      map.faults().add(item->position,
                       fmt::format("server '{}' is off this machine and without TLS", *text),
                       "tls://HOST:PORT, or without-tls: true if the network is trusted",
                       "tls" + text->substr(text->find("://")));
    }
    spec.servers.push_back(*text);
  }
}

void check_login(MapReader& map, const JetStreamSpec& spec) {
  check_pair(map, "certificate", spec.certificate, "key", spec.key, "both, as PEM files");
  check_pair(map, "user", spec.user, "password-file", spec.password_file, "both");
  const int logins = (spec.password_file.empty() ? 0 : 1) + (spec.token_file.empty() ? 0 : 1) +
                     (spec.credentials.empty() ? 0 : 1);
  if (logins > 1)
    map.fault("servers", "more than one login",
              "one of: user with password-file, token-file, credentials");
  const bool has_files = !spec.authority.empty() || !spec.certificate.empty();
  if (has_files && !uses_tls(spec))
    map.fault("servers", "'authority' or 'certificate' without a server tls://HOST:PORT",
              "servers: [tls://HOST:PORT]");
}

void check_names(MapReader& map, const JetStreamSpec& spec) {
  for (const auto& [key, name] :
       {std::pair{"sample-stream", spec.sample_stream},
        std::pair{"alarm-stream", spec.alarm_stream}, std::pair{"bucket", spec.bucket},
        std::pair{"site-bucket", spec.site_bucket}}) {
    if (name.find('.') != name.npos)
      map.fault(key, fmt::format("{} '{}' contains '.', which NATS does not allow", key, name),
                "letters, digits, '-' and '_'");
  }
}

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

const Rows<JetStreamSpec>& jetstream_rows() {
  const auto text = [](const char* name, const char* fallback, const char* what) {
    return config::Field<JetStreamSpec>{
        {.name = name, .fallback = fallback, .text = what, .schema = "{}"}};
  };
  static const Rows<JetStreamSpec> rows(
      "jetstream", "'jetstream'",
      {
          text("servers", "`[nats://127.0.0.1:4222]`",
               "of one cluster, each `nats://HOST:PORT` or `tls://HOST:PORT`; off this machine "
               "with TLS"),
          text("authority", "those of the system",
               "a PEM file with the authorities of the servers' certificates"),
          text("certificate", "none", "a PEM file with the certificate of this client"),
          text("key", "none", "a PEM file with its private key"),
          field<JetStreamSpec>({.name = "user", .fallback = "none", .text = "with `password-file`"},
                               &JetStreamSpec::user, config::TextRule{256}),
          text("password-file", "none", "a file whose first line is the password"),
          text("token-file", "none", "a file whose first line is the token"),
          text("credentials", "none", "a file with a JWT and its key, as `nsc` makes it"),
          field<JetStreamSpec>({.name = "without-tls",
                                .fallback = "`false`",
                                .text = "allows `nats://` off this machine: values and the login "
                                        "are readable in the network"},
                               &JetStreamSpec::without_tls, config::FlagRule{}),
          field<JetStreamSpec>({.name = "acknowledgement",
                                .fallback = "`5s`",
                                .text = "a message without an acknowledgement in this time is sent "
                                        "again"},
                               &JetStreamSpec::acknowledgement,
                               config::DurationRule{kLeastWait, kMostWait}),
          field<JetStreamSpec>({.name = "sample-stream",
                                .fallback = "`FIELDCAST`",
                                .text = "the name, if it is created"},
                               &JetStreamSpec::sample_stream, config::NameRule{}),
          field<JetStreamSpec>({.name = "alarm-stream",
                                .fallback = "`FIELDCAST_ALARMS`",
                                .text = "the name, if it is created"},
                               &JetStreamSpec::alarm_stream, config::NameRule{}),
          field<JetStreamSpec>({.name = "bucket",
                                .fallback = "`fieldcast-catalogue`",
                                .text = "the key-value bucket of the catalogues"},
                               &JetStreamSpec::bucket, config::NameRule{}),
          field<JetStreamSpec>({.name = "site-bucket",
                                .fallback = "`fieldcast-sites`",
                                .text = "the key-value bucket of the states of all sites"},
                               &JetStreamSpec::site_bucket, config::NameRule{}),
          text("streams", "used, not created", "how missing streams are created"),
      });
  return rows;
}

}  // namespace

OutletSpec read_jetstream(MapReader& file, const Node& section, config::Library& library) {
  JetStreamSpec spec;
  MapReader map(section, jetstream_rows(), file.faults());
  jetstream_rows().read(map, spec);
  read_servers(map, spec);
  read_files(map, library,
             {{"authority", &spec.authority},
              {"certificate", &spec.certificate},
              {"key", &spec.key},
              {"password-file", &spec.password_file},
              {"token-file", &spec.token_file},
              {"credentials", &spec.credentials}});
  check_login(map, spec);
  check_names(map, spec);
  if (const Node* streams = map.find("streams"); streams != nullptr) {
    MapReader inner(*streams, stream_rows(), file.faults());
    stream_rows().read(inner, spec.streams);
  }
  return spec;
}

void document_jetstream(const AddKeys& add) {
  add("jetstream.", jetstream_rows());
  add("jetstream.streams.", stream_rows());
}

}  // namespace fieldcast::forward
