// Sends one mail by libcurl, over a new connection. Stateless.
#pragma once

#include <functional>
#include <string>
#include <tl/expected.hpp>

#include "tools/station/notify/notify_spec.hpp"

namespace fieldcast::web {

// `mail` is a whole RFC 5322 message. Blocks at most for kLongestMail. Fails with one line, without
// secrets, also within about a second after `ended` returns true.
inline constexpr Duration kLongestMail = std::chrono::seconds{30};
[[nodiscard]] tl::expected<void, std::string> send_mail(const MailSpec& spec,
                                                        const std::string& recipient,
                                                        const std::string& mail,
                                                        const std::function<bool()>& ended);

}  // namespace fieldcast::web
