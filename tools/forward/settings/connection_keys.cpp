#include "tools/forward/settings/connection_keys.hpp"

#include <fmt/format.h>

#include "config/document/limits.hpp"
#include "config/document/scalars.hpp"
#include "tools/forward/settings/server_address.hpp"

namespace fieldcast::forward {
namespace {

using config::field;
using config::MapReader;
using config::Node;

constexpr std::size_t kMostServers = 16;
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

// The file must exist; the access to its content is checked when it is used.
void read_files(MapReader& map, JetStreamSpec& spec, config::Library& library) {
  for (const auto& [key, target] :
       {std::pair{"authority", &spec.authority}, std::pair{"certificate", &spec.certificate},
        std::pair{"key", &spec.key}, std::pair{"password-file", &spec.password_file},
        std::pair{"token-file", &spec.token_file}, std::pair{"credentials", &spec.credentials}}) {
    std::string path;
    if (map.read(key, path, config::TextRule{config::kMaxPath}))
      *target = library.check_file(*map.find(key));
  }
}

void check_login(MapReader& map, const JetStreamSpec& spec) {
  if (spec.certificate.empty() != spec.key.empty())
    map.fault(spec.key.empty() ? "certificate" : "key",
              spec.key.empty() ? "'certificate' without 'key'" : "'key' without 'certificate'",
              "both, as PEM files");
  if (spec.user.empty() != spec.password_file.empty())
    map.fault(
        spec.user.empty() ? "password-file" : "user",
        spec.user.empty() ? "'password-file' without 'user'" : "'user' without 'password-file'",
        "both");
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

}  // namespace

std::vector<config::Field<JetStreamSpec>> connection_fields() {
  const auto text = [](const char* name, const char* fallback, const char* what) {
    return config::Field<JetStreamSpec>{
        {.name = name, .fallback = fallback, .text = what, .schema = "{}"}};
  };
  return {
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
  };
}

std::vector<config::Field<JetStreamSpec>> stream_name_fields(const std::string& remark) {
  return {
      field<JetStreamSpec>(
          {.name = "sample-stream", .fallback = "`FIELDCAST`", .text = "the name" + remark},
          &JetStreamSpec::sample_stream, config::NameRule{}),
      field<JetStreamSpec>(
          {.name = "alarm-stream", .fallback = "`FIELDCAST_ALARMS`", .text = "the name" + remark},
          &JetStreamSpec::alarm_stream, config::NameRule{}),
      field<JetStreamSpec>({.name = "bucket",
                            .fallback = "`fieldcast-catalogue`",
                            .text = "the key-value bucket of the catalogues"},
                           &JetStreamSpec::bucket, config::NameRule{}),
      field<JetStreamSpec>({.name = "site-bucket",
                            .fallback = "`fieldcast-sites`",
                            .text = "the key-value bucket of the states of all sites"},
                           &JetStreamSpec::site_bucket, config::NameRule{}),
  };
}

void read_connection(MapReader& map, JetStreamSpec& spec, config::Library& library) {
  read_servers(map, spec);
  read_files(map, spec, library);
  check_login(map, spec);
  check_names(map, spec);
}

}  // namespace fieldcast::forward
