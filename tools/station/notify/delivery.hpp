// Delivers one message to its recipient, now. Stateless; blocks.
#pragma once

#include <functional>
#include <string>
#include <string_view>
#include <tl/expected.hpp>

#include "bridge/store/records/notification_records.hpp"
#include "tools/station/notify/notify_spec.hpp"

namespace fieldcast::web {

// Both fail with one line, without secrets and without the URL, also within about a second after
// `ended` returns true. A redirect is a failure.
using Ended = std::function<bool()>;
[[nodiscard]] tl::expected<void, std::string> deliver(const MailSpec& mail,
                                                      const NotifyTarget& target,
                                                      const Notification& message,
                                                      const Ended& ended = {});
[[nodiscard]] tl::expected<void, std::string> beat(const HeartbeatSpec& spec,
                                                   const std::string& station,
                                                   const Ended& ended = {});

// "sha256=<64 hexadecimal digits>": HMAC-SHA-256 (RFC 2104) of the body.
[[nodiscard]] std::string signature_of(std::string_view secret, std::string_view body);

// Checks that the files of logins and secrets can be read and are not readable by others.
[[nodiscard]] tl::expected<void, std::string> check_files(const NotifySpec& spec);

}  // namespace fieldcast::web
