// The stored samples of channels, or what they were in equal stretches of time, as one long text
// that is made piece by piece: each piece is a question to the database of its own, so that a slow
// client holds up nobody and nothing is held.
//
// Lines are those of `fieldcast history --csv` and `--json`. One owner; next() runs on the thread
// of the database, one call at a time, and throws StoreError.
#pragma once

#include <optional>
#include <string>

#include "bridge/store/sample_table.hpp"
#include "core/model/pattern.hpp"
#include "tools/station/web/gzip.hpp"

namespace fieldcast::web {

struct ExportQuestion {
  Pattern pattern;
  UtcTime from, to;
  std::optional<Duration> every;  // nothing: each sample
  bool json_lines = false;        // else CSV
  bool compress = false;
};

class Exporter {
 public:
  // A piece has at least so many bytes before compression, or took so long.
  static constexpr std::size_t kPiece = 64 << 10;
  static constexpr Duration kLongestPiece = std::chrono::milliseconds{200};

  explicit Exporter(ExportQuestion question);

  // The next piece; nothing: the text has ended.
  [[nodiscard]] std::optional<std::string> next(SqlConnection& connection);
  // The last piece, when there is no more to be had: a line that says so.
  [[nodiscard]] std::string broken_off();

 private:
  static constexpr std::int64_t kSamplesAtOnce = 2000;
  static constexpr std::int64_t kBucketsAtOnce = 1000;  // as long as that many buckets

  void begin(SqlConnection& connection);
  // Adds lines of the present channel. True: it has no more.
  [[nodiscard]] bool add_samples(SqlConnection& connection);
  [[nodiscard]] bool add_buckets(SqlConnection& connection);
  [[nodiscard]] std::string take(bool last);

  const ExportQuestion question_;
  std::optional<GzipPieces> gzip_;
  bool begun_ = false;
  bool ended_ = false;
  std::vector<StoredChannel> channels_;
  std::size_t channel_ = 0;  // in channels_
  SampleTable::Position after_;
  UtcTime bucket_;    // where the next buckets begin
  std::string text_;  // of this piece
};

}  // namespace fieldcast::web
