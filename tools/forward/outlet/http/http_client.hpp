// One HTTP connection by libcurl, which also honours `https_proxy` of the environment. Used by one
// thread.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <tl/expected.hpp>
#include <vector>

#include "tools/forward/outlet/http/http_spec.hpp"

namespace fieldcast::forward {

struct HttpResponse {
  long status = 0;
  std::string text;  // one line, at most 500 bytes
};

class HttpClient {
 public:
  // `token_scheme`: the word before a token in the header Authorization, as "Bearer". `ended`: a
  // request fails within about a second after it returns true.
  HttpClient(const HttpSpec& spec, std::string token_scheme, std::function<bool()> ended = {});
  ~HttpClient();

  // Reads the files of the login. Fails with one line with the file, without secrets.
  [[nodiscard]] tl::expected<void, std::string> open();
  // `path` follows the server. Blocks at most for `acknowledgement`. Fails with one line if there
  // is no response. REQUIRES: open() succeeded.
  [[nodiscard]] tl::expected<HttpResponse, std::string> post(
      const std::string& path, const std::vector<std::string>& headers, std::string_view body);
  // As post(). Neither follows a redirect.
  [[nodiscard]] tl::expected<HttpResponse, std::string> get(const std::string& path);

 private:
  struct Handle;
  [[nodiscard]] tl::expected<HttpResponse, std::string> perform(
      const std::string& path, const std::vector<std::string>& headers);
  const HttpSpec spec_;
  const std::string token_scheme_;
  const std::function<bool()> ended_;
  std::unique_ptr<Handle> handle_;
};

}  // namespace fieldcast::forward
