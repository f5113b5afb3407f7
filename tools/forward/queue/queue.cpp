#include "tools/forward/queue/queue.hpp"

#include <limits>
#include <utility>

#include "tools/forward/payload/codec.hpp"

namespace fieldcast::forward {

namespace {

// The lock of the file is held until it is closed. The write-ahead log is written to the file
// itself after 1000 pages of 4 KiB.
constexpr const char* kTables = R"(
pragma locking_mode = exclusive;
pragma wal_autocheckpoint = 1000;
create table if not exists records(
  id integer primary key autoincrement, kind integer not null, bus text not null,
  device text not null, epoch integer not null, identity integer not null,
  samples integer not null, appended_at integer not null, bytes integer not null,
  body blob not null, late integer not null default 0, fixed integer not null default 0);
create table if not exists catalogues(identity integer primary key, body blob not null);
create table if not exists positions(
  name text primary key, epoch integer not null, sequence integer not null) without rowid;
create table if not exists gaps(
  name text not null, after_epoch integer not null, after_sequence integer not null,
  until_epoch integer not null, until_sequence integer not null,
  primary key(name, until_epoch, until_sequence)) without rowid;
)";
// A file of an earlier version: its records may have been sent.
constexpr const char* kUpgrade = R"(
alter table records add column late integer not null default 0;
alter table records add column fixed integer not null default 0;
update records set fixed = 1;
)";
constexpr const char* kIsOld =
    "select count(*) from pragma_table_info('records') where name = 'fixed'";
// SqlConnection binds texts; the cast stores the bytes as they are.
constexpr const char* kInsert =
    "insert into records(kind, bus, device, epoch, identity, samples, appended_at, bytes, body, "
    "late, fixed) values($1, $2, $3, $4, $5, $6, $7, $8, cast($9 as blob), $10, $11)";
constexpr const char* kKeepCatalogue =
    "insert or ignore into catalogues(identity, body) values($1, cast($2 as blob))";
constexpr const char* kKeepPosition =
    "insert into positions(name, epoch, sequence) values($1, $2, $3) "
    "on conflict(name) do update set epoch = excluded.epoch, sequence = excluded.sequence";
constexpr const char* kCountUp =
    "insert into positions(name, epoch, sequence) values($1, 0, 0) "
    "on conflict(name) do update set sequence = sequence + 1 returning sequence";
constexpr const char* kKeepGap =
    "insert into gaps(name, after_epoch, after_sequence, until_epoch, until_sequence) "
    "values($1, $2, $3, $4, $5) on conflict(name, until_epoch, until_sequence) do update set "
    "after_epoch = excluded.after_epoch, after_sequence = excluded.after_sequence";
constexpr const char* kCloseGap =
    "delete from gaps where name = $1 and until_epoch = $2 and until_sequence = $3";
constexpr const char* kRead =
    "select id, kind, bus, device, epoch, identity, samples, body, late, fixed from records "
    "where id > $1 order by id";
constexpr const char* kLastBefore =
    "select id from records where id > $1 and appended_at < $2 order by id desc limit 1";
constexpr const char* kFix =
    "update records set fixed = 1 where id > $1 and id <= $2 and fixed = 0";
constexpr const char* kMerge =
    "update records set identity = $1, samples = $2, bytes = $3, body = cast($4 as blob), fixed = "
    "1 "
    "where id = $5";
constexpr const char* kRemove = "delete from records where id = $1 returning samples, bytes";
constexpr const char* kOldest =
    "select id, samples, bytes from records where kind = $1 order by id limit 64";
constexpr const char* kTooOld =
    "select id, samples, bytes from records where appended_at < $1 order by id limit 1024";
constexpr const char* kThick =
    "select id, bus, device, body from records where kind = 0 and id > $1 order by id limit 64";
// SQLite numbers the parameters in the order in which they appear.
constexpr const char* kThin =
    "update records set samples = $1, bytes = $2, body = cast($3 as blob) where id = $4";

std::int64_t as_integer(std::uint64_t number) { return static_cast<std::int64_t>(number); }
std::uint64_t number_at(const SqlRow& row, std::size_t column) {
  return static_cast<std::uint64_t>(integer_at(row, column));
}

Record record_of(const SqlRow& row) {
  return {.id = number_at(row, 0),
          .kind = static_cast<RecordKind>(integer_at(row, 1)),
          .bus = text_at(row, 2),
          .device = text_at(row, 3),
          .epoch = number_at(row, 4),
          .identity = number_at(row, 5),
          .samples = static_cast<std::uint32_t>(integer_at(row, 6)),
          .is_late = integer_at(row, 8) != 0,
          .body = text_at(row, 7)};
}

std::unique_ptr<SqlConnection> open_queue(const std::string& path) {
  try {
    auto connection = open_sqlite(path, IfMissing::kCreate);
    connection->script(kTables);
    bool is_old = false;
    connection->query(kIsOld, {}, [&is_old](const SqlRow& row) {
      is_old = integer_at(row, 0) == 0;
      return false;
    });
    if (is_old) connection->script(kUpgrade);
    SqlTransaction(*connection).commit();  // the first transaction takes the lock
    return connection;
  } catch (const StoreAway&) {
    throw;  // the disk, not a second forwarder
  } catch (const StoreError& error) {
    throw StoreError(std::string(error.what()) + "; only one fieldcast-forward may use this file");
  }
}

std::vector<SqlRow> rows_of(SqlConnection& connection, const char* sql, const SqlRow& parameters) {
  std::vector<SqlRow> rows;
  connection.query(sql, parameters, [&rows](const SqlRow& row) {
    rows.push_back(row);
    return true;
  });
  return rows;
}

}  // namespace

Queue::Queue(const QueueSpec& spec) : spec_(spec), connection_(open_queue(spec.path)) { count(); }

void Queue::count() {
  connection_->query("select count(*), coalesce(sum(bytes), 0) from records", {},
                     [this](const SqlRow& row) {
                       counters_.records = number_at(row, 0);
                       counters_.bytes = number_at(row, 1);
                       return false;
                     });
}

// If the disk is full, the write-ahead log is emptied, which may make the next attempt possible.
template <class Work>
void Queue::write(Work work) {
  const std::lock_guard lock(mutex_);
  try {
    work();
  } catch (const StoreAway&) {
    try {
      connection_->script("pragma wal_checkpoint(truncate)");
    } catch (const StoreError&) {}  // the first fault is reported
    throw;
  }
}

void Queue::append(std::span<const Record> records, std::span<const NamedPosition> positions,
                   UtcTime now, std::span<const GapChange> gaps) {
  write([&] { append_all(records, positions, now, gaps); });
}

void Queue::append_all(std::span<const Record> records, std::span<const NamedPosition> positions,
                       UtcTime now, std::span<const GapChange> gaps) {
  Counters counters = counters_;
  SqlTransaction transaction(*connection_);
  for (const Record& record : records) {
    const std::uint64_t bytes = record.body.size() + kRowBytes;
    if (record.kind == RecordKind::kCatalogue)
      connection_->execute(kKeepCatalogue, SqlRow{as_integer(record.identity), record.body});
    connection_->execute(
        kInsert, SqlRow{std::int64_t{static_cast<std::uint8_t>(record.kind)}, record.bus,
                        record.device, as_integer(record.epoch), as_integer(record.identity),
                        std::int64_t{record.samples}, now.nanoseconds, as_integer(bytes),
                        record.body, std::int64_t{record.is_late}, std::int64_t{sending_}});
    ++counters.records;
    counters.bytes += bytes;
  }
  for (const NamedPosition& each : positions)
    connection_->execute(kKeepPosition, SqlRow{each.name, as_integer(each.position.epoch),
                                               as_integer(each.position.sequence)});
  for (const GapChange& change : gaps) keep(change);
  try {
    make_space(counters);
    transaction.commit();
  } catch (const StoreError&) {
    thinning_ = {};  // the rollback restores the samples
    thinned_to_ = 0;
    throw;
  }
  counters_ = counters;
}

void Queue::keep(const GapChange& change) {
  const Gap& gap = change.gap;
  const auto until_epoch = as_integer(gap.until.epoch);
  const auto until_sequence = as_integer(gap.until.sequence);
  if (change.is_closed) {
    connection_->execute(kCloseGap, SqlRow{gap.path, until_epoch, until_sequence});
    return;
  }
  connection_->execute(kKeepGap,
                       SqlRow{gap.path, as_integer(gap.after.epoch), as_integer(gap.after.sequence),
                              until_epoch, until_sequence});
}

// Goes below the limit by kMargin, so that not each append makes space, and so that one append does
// not thin the whole queue.
void Queue::make_space(Counters& counters) {
  if (counters.bytes <= spec_.max_bytes) return;
  const std::uint64_t wanted = spec_.max_bytes - spec_.max_bytes / kMargin;
  while (counters.bytes > wanted && thin_oldest(counters)) {}
  for (const RecordKind kind :
       {RecordKind::kSamples, RecordKind::kCatalogue, RecordKind::kAlarm, RecordKind::kAudit}) {
    while (counters.bytes > wanted && drop_oldest(kind, counters)) {}
  }
}

bool Queue::thin_oldest(Counters& counters) {
  const auto rows = rows_of(*connection_, kThick, {as_integer(thinned_to_)});
  for (const SqlRow& row : rows) {
    thinned_to_ = number_at(row, 0);
    const std::string body = text_at(row, 3);
    std::optional<SampleBatch> batch = decode_samples(body);
    if (!batch) continue;
    const std::size_t removed = thinning_.thin(*batch);
    if (removed == 0) continue;
    counters.thinned += removed;
    const std::string thin = batch->samples.empty() ? "" : encode(*batch);
    counters.bytes -= body.size() - thin.size();
    if (batch->samples.empty()) {
      connection_->query(kRemove, {row[0]}, [](const SqlRow&) { return true; });
      --counters.records;
      counters.bytes -= kRowBytes;
      continue;
    }
    connection_->execute(kThin,
                         SqlRow{std::int64_t{static_cast<std::uint32_t>(batch->samples.size())},
                                as_integer(thin.size() + kRowBytes), thin, row[0]});
  }
  return !rows.empty();
}

bool Queue::drop_oldest(RecordKind kind, Counters& counters) {
  const auto rows = rows_of(*connection_, kOldest, {std::int64_t{static_cast<std::uint8_t>(kind)}});
  drop(rows, counters);
  return !rows.empty();
}

void Queue::drop(const std::vector<SqlRow>& rows, Counters& counters) {
  for (const SqlRow& row : rows) {
    connection_->query(kRemove, {row[0]}, [](const SqlRow&) { return true; });
    --counters.records;
    ++counters.dropped_records;
    counters.dropped_samples += number_at(row, 1);
    counters.bytes -= number_at(row, 2);
  }
}

Queue::Batch Queue::read(const Range& range) {
  Batch batch;
  write([&] { batch = read_part(range); });
  return batch;
}

Queue::Batch Queue::read_part(const Range& range) {
  constexpr std::size_t kMostRows = 4096, kMostRead = 2u << 20;
  Merging merging(kMergedBytes, kMergedSamples);
  Batch batch{.records = {}, .read_to = range.to};
  std::size_t rows = 0, bytes = 0;
  bool is_fixed = true;
  connection_->query(kRead, {as_integer(range.after)}, [&](const SqlRow& row) {
    Record record = record_of(row);
    if (record.id > range.to) return false;
    if (++rows > kMostRows || bytes > kMostRead) {
      batch.read_to = record.id - 1;
      return false;
    }
    bytes += record.body.size();
    const bool is_row_fixed = integer_at(row, 9) != 0;
    is_fixed = is_fixed && is_row_fixed;
    const bool can_merge = !is_row_fixed || record.id > range.unread_after;
    merging.add(std::move(record), can_merge);
    return true;
  });
  Merging::Result result = merging.take();
  if (!is_fixed || !result.merged.empty())
    store(result, {range.after, batch.read_to, range.unread_after});
  batch.records = std::move(result.records);
  return batch;
}

void Queue::store(const Merging::Result& result, const Range& range) {
  Counters counters = counters_;
  SqlTransaction transaction(*connection_);
  for (const std::uint64_t id : result.removed) remove_row(id, counters);
  for (const Record& record : result.records) {
    if (!result.merged.contains(record.id)) continue;
    const std::uint64_t bytes = record.body.size() + kRowBytes;
    connection_->query("select bytes from records where id = $1", {as_integer(record.id)},
                       [&](const SqlRow& row) {
                         counters.bytes += bytes - number_at(row, 0);
                         return false;
                       });
    connection_->execute(kMerge, SqlRow{as_integer(record.identity), std::int64_t{record.samples},
                                        as_integer(bytes), record.body, as_integer(record.id)});
  }
  connection_->execute(kFix, SqlRow{as_integer(range.after), as_integer(range.to)});
  transaction.commit();
  counters_ = counters;
}

std::uint64_t Queue::last_before(UtcTime before, std::uint64_t after) {
  const std::lock_guard lock(mutex_);
  const auto rows = rows_of(*connection_, kLastBefore, {as_integer(after), before.nanoseconds});
  return rows.empty() ? 0 : number_at(rows.front(), 0);
}

std::uint64_t Queue::last() {
  return last_before(UtcTime{std::numeric_limits<std::int64_t>::max()}, 0);
}

void Queue::set_sending(bool sending) {
  const std::lock_guard lock(mutex_);
  sending_ = sending;
}

void Queue::remove(std::span<const std::uint64_t> ids) {
  write([&] { remove_all(ids); });
}

void Queue::remove_all(std::span<const std::uint64_t> ids) {
  Counters counters = counters_;
  SqlTransaction transaction(*connection_);
  for (const std::uint64_t id : ids) remove_row(id, counters);
  transaction.commit();
  counters_ = counters;
}

// A record that was dropped meanwhile is not counted a second time.
void Queue::remove_row(std::uint64_t id, Counters& counters) {
  connection_->query(kRemove, {as_integer(id)}, [&counters](const SqlRow& row) {
    --counters.records;
    counters.bytes -= number_at(row, 1);
    return true;
  });
}

void Queue::clean(UtcTime now) {
  const std::lock_guard lock(mutex_);
  if (spec_.keep != Duration{}) {
    const SqlRow before{saturated_difference(now.nanoseconds, spec_.keep.count())};
    for (bool more = true; more;) {
      Counters counters = counters_;
      SqlTransaction transaction(*connection_);
      const auto rows = rows_of(*connection_, kTooOld, before);
      drop(rows, counters);
      transaction.commit();
      counters_ = counters;
      more = !rows.empty();
    }
  }
  connection_->script("pragma incremental_vacuum(4096)");
}

std::optional<std::string> Queue::catalogue(std::uint64_t identity) {
  const std::lock_guard lock(mutex_);
  std::optional<std::string> body;
  connection_->query("select body from catalogues where identity = $1", {as_integer(identity)},
                     [&body](const SqlRow& row) {
                       body = text_at(row, 0);
                       return false;
                     });
  return body;
}

std::vector<NamedPosition> Queue::positions() {
  const std::lock_guard lock(mutex_);
  std::vector<NamedPosition> positions;
  connection_->query(
      "select name, epoch, sequence from positions", {}, [&positions](const SqlRow& row) {
        positions.push_back({text_at(row, 0), {number_at(row, 1), number_at(row, 2)}});
        return true;
      });
  return positions;
}

std::uint64_t Queue::count_up(const std::string& name) {
  std::uint64_t number = 0;
  write([&] {
    connection_->query(kCountUp, {name}, [&number](const SqlRow& row) {
      number = number_at(row, 0);
      return true;
    });
  });
  return number;
}

UtcTime Queue::oldest() {
  const std::lock_guard lock(mutex_);
  const auto rows =
      rows_of(*connection_, "select appended_at from records order by id limit 1", {});
  return {rows.empty() ? 0 : integer_at(rows.front(), 0)};
}

std::vector<Gap> Queue::gaps() {
  const std::lock_guard lock(mutex_);
  std::vector<Gap> gaps;
  connection_->query(
      "select name, after_epoch, after_sequence, until_epoch, until_sequence from gaps", {},
      [&gaps](const SqlRow& row) {
        gaps.push_back({text_at(row, 0),
                        {number_at(row, 1), number_at(row, 2)},
                        {number_at(row, 3), number_at(row, 4)},
                        {}});
        return true;
      });
  return gaps;
}

Queue::Counters Queue::counters() const {
  const std::lock_guard lock(mutex_);
  return counters_;
}

}  // namespace fieldcast::forward
