#include "tools/forward/settings/connection_keys.hpp"

#include <fmt/format.h>

#include "config/document/limits.hpp"
#include "config/document/scalars.hpp"
#include "tools/forward/settings/login_keys.hpp"
#include "tools/forward/settings/servers_key.hpp"

namespace fieldcast::forward {
namespace {

using config::field;
using config::MapReader;

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
        std::pair{"alarm-stream", spec.alarm_stream}, std::pair{"audit-stream", spec.audit_stream},
        std::pair{"bucket", spec.bucket}, std::pair{"site-bucket", spec.site_bucket}}) {
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
  read_servers(map, "nats", spec.without_tls, spec.servers);
  read_files(map, library,
             {{"authority", &spec.authority},
              {"certificate", &spec.certificate},
              {"key", &spec.key},
              {"password-file", &spec.password_file},
              {"token-file", &spec.token_file},
              {"credentials", &spec.credentials}});
  check_login(map, spec);
  check_names(map, spec);
}

}  // namespace fieldcast::forward
