// The keys of engines that receive data by HTTP.
#pragma once

#include <vector>

#include "config/document/limits.hpp"
#include "config/document/map_reader.hpp"
#include "config/document/scalars.hpp"
#include "config/files/library.hpp"
#include "tools/forward/outlet/http/http_spec.hpp"

namespace fieldcast::forward {

// The rows of the keys; `Owner` has a member `http`. `fallback`: the default server.
template <class Owner>
[[nodiscard]] std::vector<config::Field<Owner>> http_fields(const std::string& fallback) {
  using config::field;
  const auto file = [](const char* name, const char* otherwise, const char* what) {
    return config::Field<Owner>{
        {.name = name, .fallback = otherwise, .text = what, .schema = "{}"}};
  };
  return {
      field<Owner>(
          {.name = "server",
           .fallback = "`" + fallback + "`",
           .text = "`http://HOST:PORT` or `https://HOST:PORT`, also with a path; off this "
                   "machine with TLS"},
          [](Owner& owner) -> std::string& { return owner.http.server; },
          config::TextRule{config::kMaxPath}),
      file("authority", "those of the system",
           "a PEM file with the authorities of the server's certificate"),
      file("certificate", "none", "a PEM file with the certificate of this client"),
      file("key", "none", "a PEM file with its private key"),
      field<Owner>(
          {.name = "user", .fallback = "none", .text = "with `password-file`"},
          [](Owner& owner) -> std::string& { return owner.http.user; }, config::TextRule{256}),
      file("password-file", "none", "a file whose first line is the password"),
      file("token-file", "none", "a file whose first line is the token"),
      field<Owner>(
          {.name = "without-tls",
           .fallback = "`false`",
           .text = "allows `http://` off this machine: values and the login are readable "
                   "in the network"},
          [](Owner& owner) -> bool& { return owner.http.without_tls; }, config::FlagRule{}),
      field<Owner>(
          {.name = "acknowledgement",
           .fallback = "`10s`",
           .text = "a request without a response in this time is repeated"},
          [](Owner& owner) -> Duration& { return owner.http.acknowledgement; },
          config::DurationRule{std::chrono::seconds{1}, std::chrono::minutes{5}}),
  };
}

// Reads the files and checks server and login, after the rows were read.
void read_http(config::MapReader& map, config::Library& library, HttpSpec& spec);

}  // namespace fieldcast::forward
