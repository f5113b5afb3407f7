// Database side of a Store, on the writer's thread: opens the database, writes batches, cleans up.
// A batch is one transaction. If the database refuses a row, the batch is written again in parts,
// each in a savepoint; a refused part is halved until the row is alone, which goes to the
// quarantine.
#pragma once

#include <memory>
#include <string>

#include "bridge/store/quarantine.hpp"
#include "bridge/store/retention.hpp"
#include "bridge/store/store.hpp"
#include "bridge/store/tiers/tier_writer.hpp"

namespace fieldcast {

class Store::Writer {
 public:
  using Opened = std::function<void(const KeptAlarms& kept)>;
  Writer(const StoreSpec& spec, Opened opened, std::deque<StoredChannel>& channels,
         std::mutex& mutex)
      : address_(spec.address),
        opened_(std::move(opened)),
        channels_(channels),
        mutex_(mutex),
        retention_(spec) {}

  // Writes the batch or nothing. kAway: the database is unavailable or locked, or its disk is full.
  enum class Try : unsigned char { kWritten, kRefused, kAway };
  [[nodiscard]] Try write(const Batch& batch);
  [[nodiscard]] const RefusedRows& refused() const { return refused_; }

  // One step of the tiers and one of the retention. Returns true if there is more to do.
  [[nodiscard]] bool tidy();

 private:
  struct Known {
    std::int64_t id = 0;
    bool is_text = false;
  };
  using Samples = std::deque<SampleRow>::const_iterator;
  using Events = std::deque<Event>::const_iterator;

  // All throw StoreError.
  void open();
  void write_all(const Batch& batch);
  void write_in_parts(const Batch& batch);
  template <class Row>
  void insert_in_parts(Row begin, Row end);
  void insert(Samples begin, Samples end);
  void insert(Events begin, Events end);
  void quarantine(const RecordJson& row, const std::string& reason);
  [[nodiscard]] Known ask(std::size_t index);
  [[nodiscard]] bool is_stored(const SampleRow& row);

  [[nodiscard]] StoredChannel channel(std::int64_t index) const;
  void close(const StoreError& error);
  // Clears the cached state of the database, which may have been rolled back.
  void forget();

  const StoreAddress address_;
  Opened opened_;
  std::deque<StoredChannel>& channels_;
  std::mutex& mutex_;
  std::unique_ptr<SqlConnection> connection_;
  std::map<std::int64_t, Known> known_;
  std::vector<SampleRow> rows_;
  TierWriter tiers_;
  Retention retention_;
  RefusedRows refused_;
  std::string told_;  // the last failure; it is logged once
};

}  // namespace fieldcast
