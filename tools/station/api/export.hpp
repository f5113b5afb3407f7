// GET /api/export: streams the history of any number of channels as CSV or JSON lines.
#pragma once

#include <cstddef>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "bridge/http/http_message.hpp"
#include "bridge/store/sql/sql.hpp"
#include "bridge/store/tiers/sample_table.hpp"
#include "core/model/channel_pattern.hpp"

namespace fieldcast::web {

// Limits the exports in progress, so that a slow client leaves room for other users. On the io
// thread.
class RunningExports {
 public:
  static constexpr std::size_t kMax = 4, kMaxOfUser = 2;
  // The user of an export, which ends with the last copy. Any thread.
  using Slot = std::shared_ptr<const std::string>;

  // Returns null beyond a limit.
  [[nodiscard]] Slot begin(const std::string& user);

 private:
  std::vector<std::weak_ptr<const std::string>> slots_;
};

struct ExportQuestion {
  std::vector<ChannelPath> channels;  // in this order; empty: those that match `pattern`
  Pattern pattern;
  UtcTime from, to;
  std::optional<Duration> every;  // bucket length; empty: each sample
  bool json_lines = false;        // false: CSV
  bool compress = false;
};

// The channels' names, without characters that are special in a file system.
[[nodiscard]] std::string export_file_name(const ExportQuestion& question);

// Writes stored samples or buckets in the lines of `fieldcast history --csv` and `--json`. Each
// piece is a separate query, so a slow client blocks nobody. next() runs on the database thread,
// one call at a time, and throws StoreError.
class Exporter {
 public:
  // A piece ends at this size before compression, or after this time.
  static constexpr std::size_t kPiece = 64 << 10;
  static constexpr Duration kLongestPiece = std::chrono::milliseconds{200};

  explicit Exporter(ExportQuestion question);

  [[nodiscard]] std::optional<std::string> next(SqlConnection& connection);
  // A last line with the error, for an export that failed.
  [[nodiscard]] std::string broken_off();

 private:
  static constexpr std::int64_t kSamplesAtOnce = 2000;
  // a query covers the time of this many buckets
  static constexpr std::int64_t kBucketsAtOnce = 1000;

  void begin(SqlConnection& connection);
  [[nodiscard]] bool add_samples(SqlConnection& connection);
  [[nodiscard]] bool add_buckets(SqlConnection& connection);
  [[nodiscard]] std::string take(bool last);

  const ExportQuestion question_;
  std::optional<GzipPieces> gzip_;
  bool begun_ = false;
  bool ended_ = false;
  std::vector<StoredChannel> channels_;
  std::size_t channel_ = 0;  // index in channels_
  SampleTable::Position after_;
  UtcTime bucket_;    // start of the next buckets
  std::string text_;  // of the current piece
};

}  // namespace fieldcast::web
