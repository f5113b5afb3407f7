// Reads the samples that a HistoryRequest selects. Everything throws StoreError.
#pragma once

#include "bridge/dds/topics/history_values.hpp"
#include "bridge/store/sql/sql.hpp"
#include "bridge/store/tiers/sample_table.hpp"
#include "core/base/time.hpp"

namespace fieldcast {

// Rows that a range selects, of a bus with these epochs. Pure. REQUIRES: epochs ascend.
[[nodiscard]] SampleTable::Span span_of(const HistoryRange& range, UtcTime until,
                                        const std::vector<std::uint64_t>& epochs);

class HistoryReader {
 public:
  // Bytes of the rows of one response, estimated.
  static constexpr std::size_t kMostBytes = 96'000;

  explicit HistoryReader(SqlConnection& connection)
      : samples_(connection), connection_(connection) {}

  [[nodiscard]] HistoryResponse read(const HistoryRequest& request, UtcTime now);

 private:
  [[nodiscard]] UtcTime begin_of(std::int64_t channel, const SampleTable::Span& span, UtcTime now);

  SampleTable samples_;
  SqlConnection& connection_;
};

}  // namespace fieldcast
