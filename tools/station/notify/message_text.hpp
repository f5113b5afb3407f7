// The texts of a message: a mail, and the JSON of a webhook. Pure functions. Names come from
// bridges and are not trusted: control characters are escaped and lengths are bounded.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "bridge/store/records/notification_records.hpp"
#include "tools/station/notify/notify_spec.hpp"
#include "tools/station/notify/rule_engine.hpp"

namespace fieldcast::web {

// One row for each recipient; a webhook has one without a recipient. `station`: its name.
[[nodiscard]] std::vector<Notification> rows_of(const NotifyMessage& message,
                                                const NotifySpec& spec, const std::string& station);

// A message that says that it is a test, for the first recipient.
[[nodiscard]] Notification test_row(const NotifyTarget& target, const std::string& station,
                                    UtcTime now);

// "PAGE/#/alarms?alarm=line%2Fpress%2Flevel%2Fhigh"; empty without an address of the page.
[[nodiscard]] std::string link_of(const std::string& page, const AlarmKey& alarm);

// The whole mail as RFC 5322, with lines of CR and LF, all in ASCII. REQUIRES: the name of the
// attachment has no quote and no control character.
[[nodiscard]] std::string mail_text(const Notification& message, const std::string& from);

[[nodiscard]] std::string base64(std::string_view bytes);  // RFC 4648, in one line

// The text of a header as RFC 2047: words in base64 unless it is printable ASCII. Folded.
[[nodiscard]] std::string header_text(std::string_view text);

}  // namespace fieldcast::web
