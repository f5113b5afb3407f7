// The outlet for PostgreSQL: the records of a turn are written in one transaction. A repeated
// sample has the same key and is left out by the server. After a loss it connects again, with the
// files of the login read again. Has no threads.
#pragma once

#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "bridge/store/sql/sql.hpp"
#include "tools/forward/outlet/outlet.hpp"
#include "tools/forward/outlet/postgresql/arrays.hpp"
#include "tools/forward/outlet/postgresql/postgresql_spec.hpp"

namespace fieldcast::forward {

class PostgresqlOutlet final : public Outlet {
 public:
  PostgresqlOutlet(const PostgresqlSpec& spec, OutletContext context);

  [[nodiscard]] bool is_ready(Instant now) override;
  [[nodiscard]] std::optional<std::size_t> send(const Record& record) override;
  void flush() override;
  [[nodiscard]] std::vector<OutletResult> take_results() override;

 private:
  // Records of one transaction, so that its statements need little memory and few seconds.
  static constexpr std::size_t kMostSamples = 50'000;
  static constexpr Duration kPause = std::chrono::seconds{2};  // after a failure
  static constexpr std::size_t kMaxCatalogues = 1024;          // then the ids are read again

  struct Statements {
    explicit Statements(const std::string& schema);
    std::string upsert_channels, insert_channels, select_channels, insert_samples, insert_alarm,
        insert_audit;
  };

  // Both throw StoreError; the database is then as before.
  void connect();
  // Returns the result of each record.
  [[nodiscard]] std::vector<OutletResult> write(std::span<const Record> records);
  // Adds samples to `samples`, and writes the rest. Returns false if it cannot be decoded.
  [[nodiscard]] bool write(const Record& record, SampleRows& samples);
  // Writes each record in a transaction of its own, to find those that the server refuses.
  void write_each();
  // The catalogue of a record that is not late becomes that of the table.
  const std::vector<std::int64_t>& ids_of(const Record& record, std::uint64_t identity,
                                          const DeviceCatalogue& catalogue);
  void forget();
  void fail_pending(const StoreError& error);

  const PostgresqlSpec spec_;
  const OutletContext context_;
  const Statements statements_;
  RecordDecoder decoder_;
  std::unique_ptr<SqlConnection> connection_;  // null: not connected
  Instant next_attempt_{};
  // The ids of the channels of a catalogue, by its identity.
  std::map<std::uint64_t, std::vector<std::int64_t>> ids_;
  std::map<std::string, std::uint64_t> present_;  // identity in the table, by "bus/device"
  std::vector<Record> pending_;                   // of this turn
  std::size_t pending_samples_ = 0;
  std::vector<OutletResult> results_;
};

}  // namespace fieldcast::forward
