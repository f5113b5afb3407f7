// Formats buckets as text, CSV and JSON. Pure, except for local times.
#pragma once

#include <string>

#include "bridge/store/tiers/bucket.hpp"
#include "bridge/store/tiers/sample_table.hpp"
#include "core/base/json.hpp"
#include "tools/cli/model/time_text.hpp"

namespace fieldcast::cli {

// Columns have a fixed usual width, because lines are printed one by one.
[[nodiscard]] std::string bucket_head(Zone zone);
[[nodiscard]] std::string bucket_line(const StoredChannel& channel, const Bucket& bucket,
                                      Zone zone);

// RFC 4180. min, max and average are empty if no sample was good.
[[nodiscard]] std::string bucket_csv_head();
[[nodiscard]] std::string bucket_csv(const StoredChannel& channel, const Bucket& bucket, Zone zone);

// The time is the start of the bucket in nanoseconds.
[[nodiscard]] Json bucket_json(const StoredChannel& channel, const Bucket& bucket);

}  // namespace fieldcast::cli
