// Formats samples as text and JSON. Pure functions.
#pragma once

#include <string>
#include <string_view>
#include <tl/expected.hpp>

#include "bridge/station/station.hpp"
#include "core/base/json.hpp"
#include "core/base/time.hpp"
#include "core/model/channel_pattern.hpp"
#include "tools/cli/text/output.hpp"

namespace fieldcast::cli {

// {"bus", "device", "channel", "value", "quality", "acquired_at", "sequence"}, and "device_code" if
// the device sent one. A channel that was never read has the value null and acquired_at 0.
[[nodiscard]] Json sample_json(const StationSample& sample);

// All digits (core/base/value.hpp); a float32 with those of a float. `type` is that of the
// catalogue; empty: double.
[[nodiscard]] std::string value_text(const Value& value, std::string_view type);

[[nodiscard]] Tone tone_of(Quality quality);

// "BAD_DEVICE_ERROR (02 illegal data address)"; the text only if the address determines the
// protocol. `about` may be null.
[[nodiscard]] std::string quality_text(const StationSample& sample,
                                       const StationChannel* about = nullptr);

// "0.12 s", "48 s", "3 min", "2 h"; "-" if unset. A future time counts as now.
[[nodiscard]] std::string age_text(UtcTime then, UtcTime now);

// Warns above twice the refresh, because the bridge itself may have stopped. `about` may be null.
[[nodiscard]] Tone age_tone(const StationSample& sample, const StationChannel* about, UtcTime now);

[[nodiscard]] std::string rate_text(double rate);

// "2026-11-21T03:04:05.678Z"; "-" if unset.
[[nodiscard]] std::string utc_text(UtcTime time);

// "03:04:05Z"; "-" if unset.
[[nodiscard]] std::string clock_text(UtcTime time);

// One line for logs: time, path, value and unit, quality. `about` may be null.
[[nodiscard]] std::string sample_line(const StationSample& sample, const StationChannel* about);

// The same for a channel without a bridge: "2026-11-21T03:04:05.678Z  bus/d/a  -  GONE".
[[nodiscard]] std::string gone_line(const ChannelPath& path, UtcTime now);
// {"event":"no_bridge","bus","device","channel"}
[[nodiscard]] Json gone_json(const ChannelPath& path);

// Parses and formats points in time. Local times depend on the process's time zone.
// "2026-11-21", "2026-11-21T10:30", "2026-11-21 10:30:05.25" in UTC or with an offset such as
// +01:00; "2h", "30min", "1d" before now; "now".
[[nodiscard]] tl::expected<UtcTime, std::string> parse_time(std::string_view text, UtcTime now);

enum class Zone : unsigned char { kUtc, kLocal };
// "2026-11-21T03:04:05.678Z", or "2026-11-21T04:04:05.678+01:00"; "-" if unset.
[[nodiscard]] std::string time_text(UtcTime time, Zone zone);

}  // namespace fieldcast::cli
