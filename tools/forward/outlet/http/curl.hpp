// libcurl for every client of this tree: ownership, and the options that all need.
#pragma once

#include <curl/curl.h>

#include <functional>
#include <string>
#include <tl/expected.hpp>

#include "core/base/time.hpp"

namespace fieldcast::forward {

struct FreeCurl {
  void operator()(CURL* handle) const { curl_easy_cleanup(handle); }
};
struct FreeList {
  void operator()(curl_slist* list) const { curl_slist_free_all(list); }
};

// No signals, only these protocols ("http,https"), at most `longest` for a request, and the PEM
// file of authorities unless it is empty.
void set_common_options(CURL* curl, const char* protocols, Duration longest,
                        const std::string& authority);

// Ends a transfer within about a second after `ended` returns true. The function must outlive the
// handle; an empty one is ignored.
void end_transfers_when(CURL* curl, const std::function<bool()>& ended);

// The password is the first line of the file. Fails with one line with the file.
[[nodiscard]] tl::expected<void, std::string> set_login(CURL* curl, const std::string& user,
                                                        const std::string& password_file);

// Replaces control characters by spaces.
[[nodiscard]] std::string one_line(std::string text);

}  // namespace fieldcast::forward
