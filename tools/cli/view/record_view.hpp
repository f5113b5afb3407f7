// Formats buckets as text, CSV and JSON. Pure, except for local times.
#pragma once

#include <string>
#include <vector>

#include "bridge/store/records/records.hpp"
#include "bridge/store/tiers/bucket.hpp"
#include "bridge/store/tiers/sample_table.hpp"
#include "bridge/store/users/user_table.hpp"
#include "core/base/json.hpp"
#include "tools/cli/model/sample_text.hpp"
#include "tools/cli/text/output.hpp"

namespace fieldcast::cli {

// Columns have a fixed usual width, because lines are printed one by one.
[[nodiscard]] std::string bucket_head(Zone zone);
[[nodiscard]] std::string bucket_line(const StoredChannel& channel, const Bucket& bucket,
                                      Zone zone);

// RFC 4180. min, max and average are empty if no sample was good.
[[nodiscard]] std::string bucket_csv_head();
[[nodiscard]] std::string bucket_csv(const StoredChannel& channel, const Bucket& bucket, Zone zone);

[[nodiscard]] Json bucket_json(const StoredChannel& channel, const Bucket& bucket);

[[nodiscard]] Json record_json(const StoredSample& sample);  // fields of a sample, and published_at
[[nodiscard]] Json record_json(const AuditEntry& entry);
[[nodiscard]] Json record_json(const DeviceRecord& device);
[[nodiscard]] Json record_json(const User& user);
[[nodiscard]] Json record_json(const Token& token);

[[nodiscard]] std::string history_line(const StoredSample& sample, Zone zone = Zone::kUtc);
[[nodiscard]] std::string history_csv_head();
// RFC 4180; empty for a value that was never read.
[[nodiscard]] std::string history_csv(const StoredSample& sample, Zone zone = Zone::kUtc);
[[nodiscard]] std::string audit_line(const AuditEntry& entry);

[[nodiscard]] std::vector<std::string> device_lines(const std::vector<DeviceRecord>& devices,
                                                    UtcTime now, const Screen& screen);
[[nodiscard]] std::vector<std::string> user_lines(const std::vector<User>& users,
                                                  const Screen& screen);
[[nodiscard]] std::vector<std::string> token_lines(const std::vector<Token>& tokens, UtcTime now,
                                                   const Screen& screen);

}  // namespace fieldcast::cli
