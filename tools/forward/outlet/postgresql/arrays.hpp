// Columns of rows as array literals of PostgreSQL: one statement then writes many rows. Pure.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "bridge/store/sql/sql.hpp"
#include "tools/forward/batch/sample_batch.hpp"

namespace fieldcast::forward {

// "{1,NULL,\"a \\\"b\\\"\"}" (PostgreSQL, 8.15.6).
class ArrayText {
 public:
  void add(std::int64_t number);
  void add(std::optional<double> number);  // empty: null
  void add(std::string_view text);
  void add_null();
  [[nodiscard]] std::string text() const { return text_ + "}"; }

 private:
  void begin_item();
  std::string text_ = "{";
};

// Rows of the table of samples.
class SampleRows {
 public:
  // `ids`: the ids of the channels, by their index in the catalogue of the batch. Samples of other
  // channels are left out.
  void add(const SampleBatch& batch, std::span<const std::int64_t> ids);
  [[nodiscard]] std::size_t size() const { return size_; }
  // The parameters of insert_samples().
  [[nodiscard]] SqlRow parameters() const;

 private:
  std::size_t size_ = 0;
  ArrayText channel_, epoch_, sequence_, acquired_at_, quality_, device_code_, value_, text_;
};

// The parameters of upsert_channels().
[[nodiscard]] SqlRow channel_parameters(const std::string& site, const DeviceCatalogue& catalogue);
// The parameters of insert_audit().
[[nodiscard]] SqlRow audit_parameters(const std::string& site, const AuditReport& entry);
// The parameters of insert_alarm().
// `identity`: the key of the state in the table.
[[nodiscard]] SqlRow alarm_parameters(const std::string& site, const StationAlarmStatus& alarm,
                                      std::uint64_t identity);

}  // namespace fieldcast::forward
