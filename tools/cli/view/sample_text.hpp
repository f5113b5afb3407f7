// Samples as people and scripts read them. Pure functions.
#pragma once

#include <string>
#include <string_view>

#include "bridge/station/station.hpp"
#include "core/base/json.hpp"
#include "tools/cli/view/text_table.hpp"

namespace fieldcast::cli {

// {"bus", "device", "channel", "value", "quality", "acquired_at", "sequence"}, and "device_code"
// where the device gave one. A channel that was never read has the value null and acquired_at 0.
[[nodiscard]] Json sample_json(const StationSample& sample);

// A value with every digit that it has (core/base/number_text.hpp): a float32 in those of a float.
// `type` is the catalogue's, or empty: then it is taken for a double.
[[nodiscard]] std::string value_text(const Value& value, std::string_view type);

[[nodiscard]] Tone tone_of(Quality quality);

// "BAD_DEVICE_ERROR (02 illegal data address)": with the device's own code, and its words where the
// notation of the channel's address tells whose they are. `about` may be null.
[[nodiscard]] std::string quality_text(const StationSample& sample,
                                       const StationChannel* about = nullptr);

// "0.12 s", "48 s", "3 min", "2 h"; "-" for no such time. A stamp from the future counts as now.
[[nodiscard]] std::string age_text(UtcTime then, UtcTime now);

// "2026-11-21T03:04:05.678Z"; "-" for no such time.
[[nodiscard]] std::string utc_text(UtcTime time);

// "03:04:05Z"; "-" for no such time.
[[nodiscard]] std::string clock_text(UtcTime time);

// The two lines above in one, for logs: time, path, value and unit, quality. `about` may be null.
[[nodiscard]] std::string sample_line(const StationSample& sample, const StationChannel* about);

}  // namespace fieldcast::cli
