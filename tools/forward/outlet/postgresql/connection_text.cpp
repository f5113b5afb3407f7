#include "tools/forward/outlet/postgresql/connection_text.hpp"

#include <fmt/format.h>

#include "bridge/process/secret.hpp"

namespace fieldcast::forward {

namespace {

// A server and its directory of sockets have the same position in the address. ':' and brackets are
// part of HOST:PORT.
std::string host_text(const std::string& server) {
  return server.starts_with('/') ? percent_encoded(server) : server;
}

std::string tls_text(const PostgresqlSpec& spec) {
  // Without an authority, the server's certificate cannot be checked: the loopback, or allowed.
  std::string text = "sslmode=prefer";
  if (!spec.authority.empty())
    text = "sslmode=verify-full&sslrootcert=" + percent_encoded(spec.authority);
  if (!spec.certificate.empty())
    text += fmt::format("&sslcert={}&sslkey={}", percent_encoded(spec.certificate),
                        percent_encoded(spec.key));
  return text;
}

}  // namespace

std::string percent_encoded(std::string_view text) {
  std::string encoded;
  for (const char c : text) {
    const bool is_unreserved = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') ||
                               (c >= '0' && c <= '9') ||
                               std::string_view("-._~").find(c) != std::string_view::npos;
    if (is_unreserved) {
      encoded += c;
    } else {
      encoded += fmt::format("%{:02X}", static_cast<unsigned char>(c));
    }
  }
  return encoded;
}

tl::expected<std::string, std::string> connection_text(const PostgresqlSpec& spec) {
  std::string login = percent_encoded(spec.user);
  if (!spec.password_file.empty()) {
    const auto password = read_secret_line(spec.password_file, Readers::kOwnerAndGroup);
    if (!password) return tl::make_unexpected(password.error());
    login += ':' + percent_encoded(password->text());
  }
  if (!spec.key.empty()) {
    if (auto safe = check_secret_file(spec.key, Readers::kOwnerAndGroup); !safe)
      return tl::make_unexpected(safe.error());
  }
  if (!login.empty()) login += '@';
  return fmt::format("postgresql://{}{}/{}?{}", login, host_text(spec.server),
                     percent_encoded(spec.database), tls_text(spec));
}

}  // namespace fieldcast::forward
