// The durable queue: a SQLite file in WAL mode with one row for each message that waits for its
// acknowledgement. A crash of the process loses no appended record; a power failure may lose those
// of the last seconds. Thread-safe. All functions throw StoreError; then nothing has changed.
//
// The size is bounded. When the queue is full:
//   1. the oldest samples are thinned out to one a minute of each channel;
//   2. then the oldest records of samples are dropped;
//   3. then those of catalogues;
//   4. then alarms;
//   5. the audit is dropped last.
// What was removed is counted.
#pragma once

#include <cstdint>
#include <memory>
#include <mutex>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "bridge/store/sql/sql.hpp"
#include "core/base/time.hpp"
#include "tools/backfill/gap.hpp"
#include "tools/forward/batch/record.hpp"
#include "tools/forward/batch/sample_batch.hpp"
#include "tools/forward/batch/thinning.hpp"
#include "tools/forward/queue/merging.hpp"

namespace fieldcast::forward {

struct QueueSpec {
  std::string path;
  std::uint64_t max_bytes = 1'000'000'000;
  Duration keep{};  // since append(); 0: no limit
  friend bool operator==(const QueueSpec&, const QueueSpec&) = default;
};

class Queue {
 public:
  // Of a merged record.
  static constexpr std::size_t kMergedBytes = 16u << 10, kMergedSamples = 4'000;

  // Opens or creates the file, which only its owner can read. Fails after 5 s if a second process
  // uses it.
  explicit Queue(const QueueSpec& spec);

  // Appends the records (their `id` is ignored) and keeps positions and gaps, in one transaction,
  // and makes space if the queue is full. `now` is the time for QueueSpec::keep.
  void append(std::span<const Record> records, std::span<const NamedPosition> positions,
              UtcTime now, std::span<const GapChange> gaps = {});
  struct Range {  // of ids
    std::uint64_t after = 0, to = 0;
    // Records after this id were not read before, so that no message of them was sent.
    std::uint64_t unread_after = 0;
  };
  struct Batch {
    std::vector<Record> records;
    std::uint64_t read_to = 0;  // the end of the range if nothing is left in it
  };
  // Reads a part of the range, in its order. Records of one device that were not sent yet are
  // merged in the file, up to kMergedBytes and kMergedSamples. A record that was read once is never
  // merged again: the identity of a message that was sent stays the same after a crash.
  [[nodiscard]] Batch read(const Range& range);
  // The last record after `after` that was appended before `before`; 0 if there is none.
  [[nodiscard]] std::uint64_t last_before(UtcTime before, std::uint64_t after);
  // The last record; 0 if there is none.
  [[nodiscard]] std::uint64_t last();
  // True while read() follows the end of the queue: new records need no second change to be marked
  // as read.
  void set_sending(bool sending);

  // Removes acknowledged records.
  void remove(std::span<const std::uint64_t> ids);
  // Drops records that are older than QueueSpec::keep, and returns free pages to the disk.
  void clean(UtcTime now);

  // Keeps a catalogue for the records that refer to it.
  [[nodiscard]] std::optional<std::string> catalogue(std::uint64_t identity);
  [[nodiscard]] std::vector<NamedPosition> positions();
  [[nodiscard]] std::vector<Gap> gaps();  // that are not closed
  // Returns 0, 1, 2, .. also over restarts. `name` contains a space, as no name of a channel does.
  [[nodiscard]] std::uint64_t count_up(const std::string& name);

  struct Counters {
    std::uint64_t records = 0, bytes = 0;  // that wait
    std::uint64_t thinned = 0;             // samples removed in step 1
    std::uint64_t dropped_samples = 0;     // in step 2, or too old
    std::uint64_t dropped_records = 0;     // in all steps, or too old
  };
  [[nodiscard]] Counters counters() const;
  // When the first waiting record was appended; 0 if there is none.
  [[nodiscard]] UtcTime oldest();

 private:
  // Bytes of a row without its body, as the file has them on average.
  static constexpr std::uint64_t kRowBytes = 120;

  static constexpr std::uint64_t kMargin = 50;  // part of max_bytes

  template <class Work>
  void write(Work work);
  // REQUIRES for all below: mutex_ is held.
  void append_all(std::span<const Record> records, std::span<const NamedPosition> positions,
                  UtcTime now, std::span<const GapChange> gaps);
  void keep(const GapChange& change);
  void remove_all(std::span<const std::uint64_t> ids);
  [[nodiscard]] Batch read_part(const Range& range);
  void store(const Merging::Result& result, const Range& range);
  void remove_row(std::uint64_t id, Counters& counters);
  void make_space(Counters& counters);
  // Return false if no record is left to thin or to drop.
  [[nodiscard]] bool thin_oldest(Counters& counters);
  [[nodiscard]] bool drop_oldest(RecordKind kind, Counters& counters);
  void drop(const std::vector<SqlRow>& rows, Counters& counters);
  void count();

  const QueueSpec spec_;
  mutable std::mutex mutex_;
  std::unique_ptr<SqlConnection> connection_;
  Thinning thinning_;
  std::uint64_t thinned_to_ = 0;  // records up to this id are thinned
  bool sending_ = false;
  Counters counters_;
};

}  // namespace fieldcast::forward
