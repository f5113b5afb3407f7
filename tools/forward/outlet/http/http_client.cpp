#include "tools/forward/outlet/http/http_client.hpp"

#include <algorithm>
#include <array>

#include "bridge/process/secret.hpp"
#include "tools/forward/outlet/http/curl.hpp"

namespace fieldcast::forward {

namespace {

constexpr std::size_t kMostText = 500;

// Keeps the beginning of the response.
std::size_t on_body(char* data, std::size_t, std::size_t size, void* closure) {
  auto& text = *static_cast<std::string*>(closure);
  text.append(data, std::min(size, kMostText - std::min(kMostText, text.size())));
  return size;
}

}  // namespace

struct HttpClient::Handle {
  std::unique_ptr<CURL, FreeCurl> curl{curl_easy_init()};
  std::array<char, CURL_ERROR_SIZE> error{};
  Secret token;
};

HttpClient::HttpClient(const HttpSpec& spec, std::string token_scheme, std::function<bool()> ended)
    : spec_(spec), token_scheme_(std::move(token_scheme)), ended_(std::move(ended)) {}

HttpClient::~HttpClient() = default;

tl::expected<void, std::string> HttpClient::open() {
  auto handle = std::make_unique<Handle>();
  CURL* const curl = handle->curl.get();
  if (curl == nullptr) return tl::make_unexpected("libcurl has no memory");
  set_common_options(curl, "http,https", spec_.acknowledgement, spec_.authority);
  end_transfers_when(curl, ended_);
  curl_easy_setopt(curl, CURLOPT_ERRORBUFFER, handle->error.data());
  curl_easy_setopt(curl, CURLOPT_WRITEFUNCTION, on_body);
  if (!spec_.certificate.empty()) {
    if (auto safe = check_secret_file(spec_.key, Readers::kOwnerAndGroup); !safe) return safe;
    curl_easy_setopt(curl, CURLOPT_SSLCERT, spec_.certificate.c_str());
    curl_easy_setopt(curl, CURLOPT_SSLKEY, spec_.key.c_str());
  }
  if (!spec_.user.empty()) {
    curl_easy_setopt(curl, CURLOPT_HTTPAUTH, CURLAUTH_BASIC);
    if (auto set = set_login(curl, spec_.user, spec_.password_file); !set) return set;
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
  curl_easy_setopt(curl, CURLOPT_POST, 1L);
  curl_easy_setopt(curl, CURLOPT_POSTFIELDSIZE_LARGE, static_cast<curl_off_t>(body.size()));
  curl_easy_setopt(curl, CURLOPT_POSTFIELDS, body.data());
  return perform(path, headers);
}

tl::expected<HttpResponse, std::string> HttpClient::get(const std::string& path) {
  curl_easy_setopt(handle_->curl.get(), CURLOPT_HTTPGET, 1L);
  return perform(path, {});
}

tl::expected<HttpResponse, std::string> HttpClient::perform(
    const std::string& path, const std::vector<std::string>& headers) {
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
