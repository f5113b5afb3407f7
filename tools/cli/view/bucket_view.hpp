// What channels were in equal stretches of time, as lines for people, CSV and JSON. Pure functions,
// but for the time zone.
#pragma once

#include <string>

#include "bridge/store/sample_table.hpp"
#include "bridge/store/tiers/bucket.hpp"
#include "core/base/json.hpp"
#include "tools/cli/view/time_text.hpp"

namespace fieldcast::cli {

// Columns as wide as their values usually are: any number of lines is printed as they come.
[[nodiscard]] std::string bucket_head(Zone zone);
[[nodiscard]] std::string bucket_line(const StoredChannel& channel, const Bucket& bucket,
                                      Zone zone);

// RFC 4180. min, max and average are empty where no sample was good.
[[nodiscard]] std::string bucket_csv_head();
[[nodiscard]] std::string bucket_csv(const StoredChannel& channel, const Bucket& bucket, Zone zone);

// The time is where the bucket begins, in nanoseconds.
[[nodiscard]] Json bucket_json(const StoredChannel& channel, const Bucket& bucket);

}  // namespace fieldcast::cli
