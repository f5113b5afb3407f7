#include "tools/forward/outlet/http/curl.hpp"

#include <algorithm>

#include "bridge/process/secret.hpp"

namespace fieldcast::forward {
namespace {

constexpr long kConnectMs = 3'000;

int on_progress(void* closure, curl_off_t, curl_off_t, curl_off_t, curl_off_t) {
  return (*static_cast<const std::function<bool()>*>(closure))() ? 1 : 0;
}

}  // namespace

void set_common_options(CURL* curl, const char* protocols, Duration longest,
                        const std::string& authority) {
  curl_easy_setopt(curl, CURLOPT_NOSIGNAL, 1L);
  curl_easy_setopt(curl, CURLOPT_PROTOCOLS_STR, protocols);
  curl_easy_setopt(curl, CURLOPT_CONNECTTIMEOUT_MS, kConnectMs);
  curl_easy_setopt(curl, CURLOPT_TIMEOUT_MS,
                   static_cast<long>(longest / std::chrono::milliseconds{1}));
  if (!authority.empty()) curl_easy_setopt(curl, CURLOPT_CAINFO, authority.c_str());
}

void end_transfers_when(CURL* curl, const std::function<bool()>& ended) {
  if (!ended) return;
  curl_easy_setopt(curl, CURLOPT_NOPROGRESS, 0L);
  curl_easy_setopt(curl, CURLOPT_XFERINFOFUNCTION, on_progress);
  // libcurl stores it as a void*, and on_progress does not change it
  curl_easy_setopt(curl, CURLOPT_XFERINFODATA, const_cast<std::function<bool()>*>(&ended));
}

tl::expected<void, std::string> set_login(CURL* curl, const std::string& user,
                                          const std::string& password_file) {
  const auto password = read_secret_line(password_file, Readers::kOwnerAndGroup);
  if (!password) return tl::make_unexpected(password.error());
  std::string text(password->text());
  curl_easy_setopt(curl, CURLOPT_USERNAME, user.c_str());
  curl_easy_setopt(curl, CURLOPT_PASSWORD, text.c_str());
  wipe(text);
  return {};
}

std::string one_line(std::string text) {
  std::replace_if(
      text.begin(), text.end(), [](unsigned char c) { return c < ' '; }, ' ');
  while (!text.empty() && text.back() == ' ') text.pop_back();
  return text;
}

}  // namespace fieldcast::forward
