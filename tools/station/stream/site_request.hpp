// Commands of users as requests to the forwarder of a site, and its responses. Pure.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <utility>

#include "bridge/station/station.hpp"
#include "core/base/time.hpp"
#include "tools/forward/command/command_request.hpp"

namespace fieldcast::web {

struct SiteRequest {
  std::string subject;  // "fieldcast-command.SITE.USER"
  std::string text;
};

// `id`: unique for the user over restarts of the station. `now`: by the clock of this station.
// Empty if the bus names no site, or if the forwarder has no such action.
[[nodiscard]] std::optional<SiteRequest> site_request_of(const StationCommand& command,
                                                         std::string id, UtcTime now);
[[nodiscard]] std::optional<SiteRequest> site_request_of(const AlarmAction& action, std::string id,
                                                         UtcTime now);

// The response of a site. Untrusted: kNoResult for a text that is not a response, and if the site
// does not know whether the command was run.
[[nodiscard]] StationOutcome site_outcome_from(std::string_view text, std::uint64_t request_id);

}  // namespace fieldcast::web
