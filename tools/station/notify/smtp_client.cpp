#include "tools/station/notify/smtp_client.hpp"

#include <fmt/format.h>
#include <sys/socket.h>

#include <array>
#include <cstring>
#include <memory>
#include <string_view>

#include "tools/forward/outlet/http/curl.hpp"

namespace fieldcast::web {
namespace {

std::size_t on_read(char* buffer, std::size_t size, std::size_t count, void* closure) {
  auto& rest = *static_cast<std::string_view*>(closure);
  const std::size_t bytes = std::min(size * count, rest.size());
  std::memcpy(buffer, rest.data(), bytes);
  rest.remove_prefix(bytes);
  return bytes;
}

// When the handle is freed, libcurl sends QUIT and waits up to two minutes for the response,
// whatever the limits of the transfer are. With a closed socket it does not wait; the server still
// receives QUIT after a success.
void do_not_wait_for_quit(CURL* curl, bool success) {
  curl_socket_t socket = CURL_SOCKET_BAD;
  curl_easy_getinfo(curl, CURLINFO_ACTIVESOCKET, &socket);
  if (socket != CURL_SOCKET_BAD) ::shutdown(socket, success ? SHUT_RD : SHUT_RDWR);
}

}  // namespace

tl::expected<void, std::string> send_mail(const MailSpec& spec, const std::string& recipient,
                                          const std::string& mail,
                                          const std::function<bool()>& ended) {
  const std::unique_ptr<CURL, forward::FreeCurl> owned(curl_easy_init());
  CURL* const curl = owned.get();
  if (curl == nullptr) return tl::make_unexpected("libcurl has no memory");
  std::array<char, CURL_ERROR_SIZE> error{};
  forward::set_common_options(curl, "smtp,smtps", kLongestMail, spec.authority);
  // For libcurl, the greeting belongs to the connection; servers delay it against spam (postscreen
  // of Postfix: 6 s).
  curl_easy_setopt(curl, CURLOPT_CONNECTTIMEOUT_MS,
                   static_cast<long>(kLongestMail / std::chrono::milliseconds{1}));
  forward::end_transfers_when(curl, ended);
  curl_easy_setopt(curl, CURLOPT_ERRORBUFFER, error.data());
  curl_easy_setopt(curl, CURLOPT_USE_SSL,
                   static_cast<long>(spec.without_tls ? CURLUSESSL_NONE : CURLUSESSL_ALL));
  if (!spec.user.empty()) {
    if (auto set = forward::set_login(curl, spec.user, spec.password_file); !set) return set;
  }
  const std::string from = '<' + spec.from + '>', to = '<' + recipient + '>';
  const std::unique_ptr<curl_slist, forward::FreeList> recipients(
      curl_slist_append(nullptr, to.c_str()));
  std::string_view rest = mail;
  curl_easy_setopt(curl, CURLOPT_URL, spec.server.c_str());
  curl_easy_setopt(curl, CURLOPT_MAIL_FROM, from.c_str());
  curl_easy_setopt(curl, CURLOPT_MAIL_RCPT, recipients.get());
  curl_easy_setopt(curl, CURLOPT_READFUNCTION, on_read);
  curl_easy_setopt(curl, CURLOPT_READDATA, &rest);
  curl_easy_setopt(curl, CURLOPT_UPLOAD, 1L);
  const CURLcode code = curl_easy_perform(curl);
  do_not_wait_for_quit(curl, code == CURLE_OK);
  if (code == CURLE_OK) return {};
  long response = 0;
  curl_easy_getinfo(curl, CURLINFO_RESPONSE_CODE, &response);
  const char* const text = error[0] == '\0' ? curl_easy_strerror(code) : error.data();
  return tl::make_unexpected(forward::one_line(
      response == 0 ? std::string(text) : fmt::format("{} (response {})", text, response)));
}

}  // namespace fieldcast::web
