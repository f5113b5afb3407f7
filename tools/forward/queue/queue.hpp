// The durable queue: a SQLite file in WAL mode with one row for each message that waits for its
// acknowledgement. A crash of the process loses no appended record; a power failure may lose those
// of the last seconds. Thread-safe. All functions throw StoreError; then nothing has changed.
//
// The size is bounded. When the queue is full:
//   1. the oldest samples are thinned out to one a minute of each channel;
//   2. then the oldest records of samples are dropped;
//   3. then those of catalogues;
//   4. alarms are dropped last.
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
#include "tools/forward/batch/sample_batch.hpp"
#include "tools/forward/batch/thinning.hpp"

namespace fieldcast::forward {

// The numbers are stored.
enum class RecordKind : std::uint8_t { kSamples = 0, kCatalogue = 1, kAlarm = 2 };

struct Record {
  std::uint64_t id = 0;  // ascending in the order of append()
  RecordKind kind = RecordKind::kSamples;
  std::string bus, device;
  std::uint64_t epoch = 0;     // of samples
  std::uint64_t identity = 0;  // of the whole content; thinning does not change it
  std::uint32_t samples = 0;
  std::string body;  // protobuf
};

struct QueueSpec {
  std::string path;
  std::uint64_t max_bytes = 1'000'000'000;
  Duration keep{};  // since append(); 0: no limit
  friend bool operator==(const QueueSpec&, const QueueSpec&) = default;
};

class Queue {
 public:
  // Opens or creates the file, which only its owner can read. Fails after 5 s if a second process
  // uses it.
  explicit Queue(const QueueSpec& spec);

  // Appends the records (their `id` is ignored) and keeps the positions, in one transaction, and
  // makes space if the queue is full. `now` is the time for QueueSpec::keep.
  void append(std::span<const Record> records, std::span<const NamedPosition> positions,
              UtcTime now);
  // Records after `id`, in their order; at least one if there is one.
  [[nodiscard]] std::vector<Record> read(std::uint64_t after, std::size_t most_records,
                                         std::size_t most_bytes);
  // Removes acknowledged records.
  void remove(std::span<const std::uint64_t> ids);
  // Drops records that are older than QueueSpec::keep, and returns free pages to the disk.
  void clean(UtcTime now);

  // Keeps a catalogue for the records that refer to it.
  [[nodiscard]] std::optional<std::string> catalogue(std::uint64_t identity);
  [[nodiscard]] std::vector<NamedPosition> positions();

  struct Counters {
    std::uint64_t records = 0, bytes = 0;  // that wait
    std::uint64_t thinned = 0;             // samples removed in step 1
    std::uint64_t dropped_samples = 0;     // in step 2, or too old
    std::uint64_t dropped_records = 0;     // in all steps, or too old
  };
  [[nodiscard]] Counters counters() const;

 private:
  // Bytes of a row without its body, as the file has them on average.
  static constexpr std::uint64_t kRowBytes = 120;

  static constexpr std::uint64_t kMargin = 50;  // part of max_bytes

  template <class Work>
  void write(Work work);
  // REQUIRES for all below: mutex_ is held.
  void append_all(std::span<const Record> records, std::span<const NamedPosition> positions,
                  UtcTime now);
  void remove_all(std::span<const std::uint64_t> ids);
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
  Counters counters_;
};

}  // namespace fieldcast::forward
