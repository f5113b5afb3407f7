#include "tools/forward/outlet/http/http_client.hpp"

#include <curl/curl.h>

#include <algorithm>
#include <array>

#include "bridge/process/secret.hpp"

namespace fieldcast::forward {

namespace {

constexpr long kConnectMs = 3'000;
constexpr std::size_t kMostText = 500;

struct FreeCurl {
  void operator()(CURL* handle) const { curl_easy_cleanup(handle); }
};
struct FreeList {
  void operator()(curl_slist* list) const { curl_slist_free_all(list); }
};

// Keeps the beginning of the response.
std::size_t on_body(char* data, std::size_t, std::size_t size, void* closure) {
  auto& text = *static_cast<std::string*>(closure);
  text.append(data, std::min(size, kMostText - std::min(kMostText, text.size())));
  return size;
}

std::string one_line(std::string text) {
  std::replace_if(
      text.begin(), text.end(), [](unsigned char c) { return c < ' '; }, ' ');
  while (!text.empty() && text.back() == ' ') text.pop_back();
  return text;
}

}  // namespace

struct HttpClient::Handle {
  std::unique_ptr<CURL, FreeCurl> curl{curl_easy_init()};
  std::array<char, CURL_ERROR_SIZE> error{};
  Secret token;
};

HttpClient::HttpClient(const HttpSpec& spec, std::string token_scheme)
    : spec_(spec), token_scheme_(std::move(token_scheme)) {}

HttpClient::~HttpClient() = default;

tl::expected<void, std::string> HttpClient::open() {
  auto handle = std::make_unique<Handle>();
  CURL* const curl = handle->curl.get();
  if (curl == nullptr) return tl::make_unexpected("libcurl has no memory");
  curl_easy_setopt(curl, CURLOPT_NOSIGNAL, 1L);
  curl_easy_setopt(curl, CURLOPT_PROTOCOLS_STR, "http,https");
  curl_easy_setopt(curl, CURLOPT_CONNECTTIMEOUT_MS, kConnectMs);
  curl_easy_setopt(curl, CURLOPT_TIMEOUT_MS,
                   static_cast<long>(spec_.acknowledgement / std::chrono::milliseconds{1}));
  curl_easy_setopt(curl, CURLOPT_ERRORBUFFER, handle->error.data());
  curl_easy_setopt(curl, CURLOPT_WRITEFUNCTION, on_body);
  if (!spec_.authority.empty()) curl_easy_setopt(curl, CURLOPT_CAINFO, spec_.authority.c_str());
  if (!spec_.certificate.empty()) {
    if (auto safe = check_secret_file(spec_.key, Readers::kOwnerAndGroup); !safe) return safe;
    curl_easy_setopt(curl, CURLOPT_SSLCERT, spec_.certificate.c_str());
    curl_easy_setopt(curl, CURLOPT_SSLKEY, spec_.key.c_str());
  }
  if (!spec_.user.empty()) {
    const auto password = read_secret_line(spec_.password_file, Readers::kOwnerAndGroup);
    if (!password) return tl::make_unexpected(password.error());
    std::string text(password->text());
    curl_easy_setopt(curl, CURLOPT_HTTPAUTH, CURLAUTH_BASIC);
    curl_easy_setopt(curl, CURLOPT_USERNAME, spec_.user.c_str());
    curl_easy_setopt(curl, CURLOPT_PASSWORD, text.c_str());
    wipe(text);
  }
  if (!spec_.token_file.empty()) {
    const auto token = read_secret_line(spec_.token_file, Readers::kOwnerAndGroup);
    if (!token) return tl::make_unexpected(token.error());
    handle->token = *token;
  }
  handle_ = std::move(handle);
  return {};
}

tl::expected<HttpResponse, std::string> HttpClient::post(const std::string& path,
                                                         const std::vector<std::string>& headers,
                                                         std::string_view body) {
  CURL* const curl = handle_->curl.get();
  curl_slist* list = curl_slist_append(nullptr, "Expect:");  // no round trip before the body
  for (const std::string& header : headers) list = curl_slist_append(list, header.c_str());
  if (!handle_->token.empty()) {
    std::string header = "Authorization: " + token_scheme_ + ' ';
    header += handle_->token.text();
    list = curl_slist_append(list, header.c_str());
    wipe(header);
  }
  const std::unique_ptr<curl_slist, FreeList> owned(list);
  HttpResponse response;
  const std::string url = spec_.server + path;
  curl_easy_setopt(curl, CURLOPT_URL, url.c_str());
  curl_easy_setopt(curl, CURLOPT_HTTPHEADER, list);
  curl_easy_setopt(curl, CURLOPT_POST, 1L);
  curl_easy_setopt(curl, CURLOPT_POSTFIELDSIZE_LARGE, static_cast<curl_off_t>(body.size()));
  curl_easy_setopt(curl, CURLOPT_POSTFIELDS, body.data());
  curl_easy_setopt(curl, CURLOPT_WRITEDATA, &response.text);
  handle_->error[0] = '\0';
  const CURLcode code = curl_easy_perform(curl);
  curl_easy_setopt(curl, CURLOPT_HTTPHEADER, nullptr);
  if (code != CURLE_OK)
    return tl::make_unexpected(
        one_line(handle_->error[0] == '\0' ? curl_easy_strerror(code) : handle_->error.data()));
  curl_easy_getinfo(curl, CURLINFO_RESPONSE_CODE, &response.status);
  response.text = one_line(std::move(response.text));
  return response;
}

}  // namespace fieldcast::forward
