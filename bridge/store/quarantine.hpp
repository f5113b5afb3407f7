// Rows that the database refused, with the reason; the newest kMaxKept. Throws StoreError.
#pragma once

#include <string>

#include "bridge/store/records/records.hpp"
#include "bridge/store/sql/sql.hpp"
#include "bridge/store/tiers/sample_table.hpp"
#include "core/base/time.hpp"

namespace fieldcast {

class QuarantineTable {
 public:
  static constexpr std::int64_t kMaxKept = 10'000;

  explicit QuarantineTable(SqlConnection& connection) : connection_(connection) {}

  // `table`: the table that refused the row. `content`: the row as JSON.
  void insert(UtcTime at, const std::string& table, const std::string& content,
              const std::string& reason);
  void remove_oldest();

 private:
  SqlConnection& connection_;
};

// Records of the store as text: one line for the log, and JSON for the quarantine. Pure functions.
[[nodiscard]] std::string log_text(const AuditEntry& entry);
[[nodiscard]] std::string log_text(const AlarmRecord& alarm);
[[nodiscard]] std::string log_text(const KeptAlarm& alarm);
[[nodiscard]] std::string log_text(const KeptMaintenance& maintenance);
[[nodiscard]] std::string log_text(const AlarmEvent& event);
[[nodiscard]] std::string log_text(const DeviceRecord& device);
[[nodiscard]] std::string log_text(const BusEpoch& epoch);

// A JSON object in ASCII: table and columns. Invalid UTF-8 as \xE4, non-finite numbers as text.
struct RecordJson {
  std::string table;
  std::string content;
};
[[nodiscard]] RecordJson json_of(const AuditEntry& entry);
[[nodiscard]] RecordJson json_of(const AlarmRecord& alarm);
[[nodiscard]] RecordJson json_of(const KeptAlarm& alarm);
[[nodiscard]] RecordJson json_of(const KeptMaintenance& maintenance);
[[nodiscard]] RecordJson json_of(const AlarmEvent& event);
[[nodiscard]] RecordJson json_of(const DeviceRecord& device);
[[nodiscard]] RecordJson json_of(const BusEpoch& epoch);
[[nodiscard]] RecordJson json_of(const StoredChannel& channel, const SampleRow& sample);

}  // namespace fieldcast
