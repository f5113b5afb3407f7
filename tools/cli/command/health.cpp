#include "tools/cli/command/health.hpp"

#include <openssl/err.h>
#include <openssl/http.h>
#include <openssl/ssl.h>
#include <openssl/x509v3.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <ctime>
#include <memory>
#include <ostream>
#include <string_view>

#include "bridge/base/released_by.hpp"
#include "tools/cli/text/output.hpp"

namespace fieldcast::cli {
namespace {

using Bio = std::unique_ptr<BIO, ReleasedBy<BIO_free_all>>;
using TlsContext = std::unique_ptr<SSL_CTX, ReleasedBy<SSL_CTX_free>>;

void release_headers(STACK_OF(CONF_VALUE) * headers) {
  sk_CONF_VALUE_pop_free(headers, X509V3_conf_free);
}

// Called by OpenSSL after the connection is open, and again before it is closed.
BIO* put_tls_above(BIO* connection, void* context, int connected, int /*ok*/) {
  if (connected == 0) return connection;
  BIO* tls = BIO_new_ssl(static_cast<SSL_CTX*>(context), 1);
  return tls ? BIO_push(tls, connection) : nullptr;
}

// The oldest error is the cause of the others.
std::string reason() {
  const char* detail = nullptr;
  int flags = 0;
  const unsigned long error = ERR_peek_error_all(nullptr, nullptr, nullptr, &detail, &flags);
  const char* words = ERR_reason_error_string(error);
  std::string text = words ? words : "no response";
  if ((flags & ERR_TXT_STRING) != 0 && detail && *detail != '\0')
    text += ": " + std::string(detail);
  return text;
}

}  // namespace

ExitCode health(const HealthOptions& options, const Streams& to) {
  // The `Host` of HTTP has the port, which OpenSSL omits.
  const std::size_t scheme = options.url.find("://");
  if (scheme == std::string::npos || options.url.find_first_of("\r\n ") != std::string::npos)
    return usage_fault(to.err, "health",
                       "'" + options.url + "' is not a URL; expected http://HOST:PORT/healthz");
  const std::string rest = options.url.substr(scheme + 3);
  STACK_OF(CONF_VALUE)* added = nullptr;
  X509V3_add_value("Host", rest.substr(0, rest.find('/')).c_str(), &added);
  const std::unique_ptr<STACK_OF(CONF_VALUE), ReleasedBy<release_headers>> headers(added);

  // The certificate is not verified: the request has no secret, and the response is only a state.
  const TlsContext tls(SSL_CTX_new(TLS_client_method()));
  const bool secure = options.url.starts_with("https://");
  const auto seconds = std::chrono::ceil<std::chrono::seconds>(options.timeout).count();
  ERR_clear_error();
  constexpr std::size_t kMostBytes = 65536;
  const Bio response(OSSL_HTTP_get(options.url.c_str(), nullptr, "*", nullptr, nullptr,
                                   secure ? put_tls_above : nullptr, tls.get(), 0, added, nullptr,
                                   0, kMostBytes, static_cast<int>(seconds)));
  // OpenSSL 3.5 returns the body of a response with any status, without the status, and possibly
  // before it has arrived.
  std::array<char, 128> body{};
  int size = response ? BIO_read(response.get(), body.data(), body.size()) : 0;
  const std::time_t end = std::time(nullptr) + seconds;
  while (size <= 0 && response && BIO_should_retry(response.get()) != 0 &&
         BIO_wait(response.get(), end, 0) > 0)
    size = BIO_read(response.get(), body.data(), body.size());
  const std::string_view text(body.data(), static_cast<std::size_t>(std::max(size, 0)));
  if (text.starts_with("ok")) return ExitCode::kOk;
  to.err << "fieldcast health: " << options.url << ": "
         << (response ? printable(text.substr(0, text.find('\n'))) : reason()) << '\n';
  return ExitCode::kFound;
}

namespace {

void describe_health(CommandLine& line, HealthOptions& options) {
  line.text("URL", options.url,
            "http://HOST:PORT/healthz of `metrics` of a bridge or of `web` of a station; https for "
            "a station with TLS")
      .required();
  line.duration("--timeout", options.timeout, std::chrono::seconds{1},
                "Give up after this time (3)");
}

}  // namespace

CommandRow health_command() {
  return command_row("health",
                     "Check that a bridge or a station responds, for a supervisor; exit code 1 if "
                     "not",
                     describe_health, health);
}

}  // namespace fieldcast::cli
