#include "tools/forward/settings/postgresql_keys.hpp"

#include <fmt/format.h>

#include "config/document/limits.hpp"
#include "config/document/scalars.hpp"
#include "config/sections/port_text.hpp"
#include "tools/forward/settings/login_keys.hpp"
#include "tools/forward/settings/server_address.hpp"

namespace fieldcast::forward {
namespace {

using config::field;
using config::MapReader;
using config::Node;
using config::Rows;

void check_server(MapReader& map, const PostgresqlSpec& spec) {
  if (spec.server.starts_with('/')) return;
  const auto host_port = config::host_port_from(spec.server);
  if (!host_port) {
    map.fault("server", fmt::format("server '{}' names no host and port", spec.server),
              "HOST:PORT, or the directory of a Unix socket");
    return;
  }
  if (!is_loopback(host_port->first) && spec.authority.empty() && !spec.without_tls)
    map.fault("server", fmt::format("server '{}' is off this machine and without TLS", spec.server),
              "'authority' with the PEM file that signed its certificate, or without-tls: true if "
              "the network is trusted");
}

const Rows<PostgresqlSpec>& postgresql_rows() {
  const auto file = [](const char* name, const char* fallback, const char* what) {
    return config::Field<PostgresqlSpec>{
        {.name = name, .fallback = fallback, .text = what, .schema = "{}"}};
  };
  static const Rows<PostgresqlSpec> rows(
      "postgresql", "'postgresql'",
      {
          field<PostgresqlSpec>({.name = "server",
                                 .fallback = "`127.0.0.1:5432`",
                                 .text = "`HOST:PORT`, or the directory of a Unix socket; off this "
                                         "machine with TLS"},
                                &PostgresqlSpec::server, config::TextRule{config::kMaxPath}),
          field<PostgresqlSpec>({.name = "database", .fallback = "`fieldcast`", .text = "its name"},
                                &PostgresqlSpec::database, config::TextRule{63}),
          field<PostgresqlSpec>({.name = "user",
                                 .fallback = "the user of the program",
                                 .text = "the role that writes"},
                                &PostgresqlSpec::user, config::TextRule{63}),
          file("password-file", "none", "a file whose first line is the password"),
          file("authority", "none",
               "a PEM file with the authority of the server's certificate; then TLS is required"),
          file("certificate", "none", "a PEM file with the certificate of this client"),
          file("key", "none", "a PEM file with its private key"),
          field<PostgresqlSpec>({.name = "without-tls",
                                 .fallback = "`false`",
                                 .text = "allows a server off this machine without `authority`: "
                                         "values and the login may be readable in the network"},
                                &PostgresqlSpec::without_tls, config::FlagRule{}),
          field<PostgresqlSpec>(
              {.name = "schema", .fallback = "`fieldcast`", .text = "the schema of the tables"},
              &PostgresqlSpec::schema, config::NameRule{}),
          field<PostgresqlSpec>({.name = "create",
                                 .fallback = "`false`",
                                 .text = "creates the schema and its tables if they are missing; "
                                         "existing ones are not changed"},
                                &PostgresqlSpec::create, config::FlagRule{}),
      });
  return rows;
}

}  // namespace

OutletSpec read_postgresql(MapReader& file, const Node& section, config::Library& library) {
  PostgresqlSpec spec;
  MapReader map(section, postgresql_rows(), file.faults());
  postgresql_rows().read(map, spec);
  read_files(map, library,
             {{"password-file", &spec.password_file},
              {"authority", &spec.authority},
              {"certificate", &spec.certificate},
              {"key", &spec.key}});
  check_server(map, spec);
  check_pair(map, "certificate", spec.certificate, "key", spec.key, "both, as PEM files");
  if (!spec.password_file.empty() && spec.user.empty())
    map.fault("password-file", "'password-file' without 'user'", "both");
  return spec;
}

void document_postgresql(const AddKeys& add) { add("postgresql.", postgresql_rows()); }

}  // namespace fieldcast::forward
