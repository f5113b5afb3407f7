// Samples and alarms in the line protocol of InfluxDB (docs.influxdata.com, "Line protocol"). Pure.
#pragma once

#include <string>
#include <string_view>

#include "tools/forward/batch/sample_batch.hpp"

namespace fieldcast::forward {

// fieldcast,bus=line,channel=speed,device=press,quality=GOOD,site=north value=2.5,epoch=7i,
// sequence=3i 1764360000000000000
//
// The quality is a tag, because a sample that becomes uncertain is published with its old time. One
// line for each sample; a channel beyond the end of `catalogue` is left out.
[[nodiscard]] std::string to_lines(std::string_view site, const SampleBatch& batch,
                                   const DeviceCatalogue& catalogue);
[[nodiscard]] std::string to_line(std::string_view site, const StationAlarmStatus& alarm);

// Tags: a backslash before ',', '=' and ' '. A line break becomes a space.
[[nodiscard]] std::string escaped_tag(std::string_view text);
// Strings: in quotes, with a backslash before '"' and '\'.
[[nodiscard]] std::string quoted_field(std::string_view text);

}  // namespace fieldcast::forward
