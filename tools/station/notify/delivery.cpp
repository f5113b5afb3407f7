#include "tools/station/notify/delivery.hpp"

#include <fmt/format.h>
#include <sodium.h>

#include <array>
#include <vector>

#include "bridge/process/secret.hpp"
#include "core/base/json.hpp"
#include "core/base/message_text.hpp"
#include "tools/forward/outlet/http/http_client.hpp"
#include "tools/station/notify/message_text.hpp"
#include "tools/station/notify/smtp_client.hpp"

namespace fieldcast::web {
namespace {

using forward::HttpClient;
using forward::HttpSpec;
using Result = tl::expected<void, std::string>;

const unsigned char* bytes_of(std::string_view text) {
  return reinterpret_cast<const unsigned char*>(text.data());
}

// With the URL of the file, if there is one.
tl::expected<HttpSpec, std::string> with_url(HttpSpec spec, const std::string& url_file) {
  if (url_file.empty()) return spec;
  const auto url = read_secret_line(url_file, Readers::kOwnerAndGroup);
  if (!url) return tl::make_unexpected(url.error());
  spec.server = std::string(url->text());
  if (spec.server.starts_with("https://") || spec.without_tls) return spec;
  return tl::make_unexpected(url_file + ": expected a URL https://HOST/PATH");
}

Result checked(const tl::expected<forward::HttpResponse, std::string>& response) {
  if (!response) return tl::make_unexpected(response.error());
  if (response->status >= 200 && response->status < 300) return {};
  if (response->status >= 300 && response->status < 400)
    return tl::make_unexpected(fmt::format(
        "response {}: redirects are not followed; configure the final URL", response->status));
  return tl::make_unexpected(
      fmt::format("response {} {}", response->status, printable(response->text, 200)));
}

Result post(const NotifyTarget& target, const Notification& message, const Ended& ended) {
  const auto spec = with_url(target.webhook, target.url_file);
  if (!spec) return tl::make_unexpected(spec.error());
  std::vector<std::string> headers{"Content-Type: application/json", "Fieldcast-Id: " + message.id};
  if (!target.secret_file.empty()) {
    const auto secret = read_secret_line(target.secret_file, Readers::kOwnerAndGroup);
    if (!secret) return tl::make_unexpected(secret.error());
    headers.push_back("Fieldcast-Signature: " + signature_of(secret->text(), message.json));
  }
  HttpClient client(*spec, "Bearer", ended);
  if (auto opened = client.open(); !opened) return opened;
  return checked(client.post("", headers, message.json));
}

}  // namespace

std::string signature_of(std::string_view secret, std::string_view body) {
  crypto_auth_hmacsha256_state state;
  crypto_auth_hmacsha256_init(&state, bytes_of(secret), secret.size());
  crypto_auth_hmacsha256_update(&state, bytes_of(body), body.size());
  std::array<unsigned char, crypto_auth_hmacsha256_BYTES> code{};
  crypto_auth_hmacsha256_final(&state, code.data());
  std::string text = "sha256=";
  for (const unsigned byte : code) text += fmt::format("{:02x}", byte);
  return text;
}

Result deliver(const MailSpec& mail, const NotifyTarget& target, const Notification& message,
               const Ended& ended) {
  if (target.mail.empty()) return post(target, message, ended);
  return send_mail(mail, message.recipient, mail_text(message, mail.from), ended);
}

Result beat(const HeartbeatSpec& spec, const std::string& station, const Ended& ended) {
  const auto http = with_url(spec.http, spec.url_file);
  if (!http) return tl::make_unexpected(http.error());
  HttpClient client(*http, "Bearer", ended);
  if (auto opened = client.open(); !opened) return opened;
  if (spec.get) return checked(client.get(""));
  return checked(client.post("", {"Content-Type: application/json"},
                             JsonObject().add("station", station).take()));
}

Result check_files(const NotifySpec& spec) {
  std::vector<std::string> files{spec.mail.password_file, spec.heartbeat.url_file};
  for (const NotifyTarget& target : spec.targets) {
    files.push_back(target.url_file);
    files.push_back(target.secret_file);
    files.push_back(target.webhook.token_file);
  }
  for (const std::string& file : files) {
    if (file.empty()) continue;
    if (const auto line = read_secret_line(file, Readers::kOwnerAndGroup); !line)
      return tl::make_unexpected(line.error());
  }
  return {};
}

}  // namespace fieldcast::web
