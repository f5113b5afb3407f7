#include "bridge/store/store_writer.hpp"

#include <algorithm>
#include <utility>

#include "bridge/base/clock.hpp"
#include "bridge/log/log.hpp"
#include "bridge/store/alarm_life_table.hpp"
#include "bridge/store/event_table.hpp"
#include "bridge/store/quarantine.hpp"
#include "bridge/store/tiers/epoch_table.hpp"

namespace fieldcast {
namespace {

constexpr std::ptrdiff_t kRowsAtOnce = 4096;  // copied at a time

template <class Record>
void insert_event(SqlConnection& connection, const Record& record) {
  if constexpr (std::is_same_v<Record, AuditEntry> || std::is_same_v<Record, AlarmRecord> ||
                std::is_same_v<Record, DeviceRecord>) {
    EventTable(connection).insert(record);
  } else if constexpr (std::is_same_v<Record, BusEpoch>) {
    EpochTable(connection).insert(record);
  } else {
    AlarmLifeTable(connection).insert(record);
  }
}

}  // namespace

Store::Writer::Try Store::Writer::write(const Batch& batch) {
  try {
    open();
    refused_ = {};
    try {
      write_all(batch);
    } catch (const StoreRowRefused&) {
      forget();
      write_in_parts(batch);
    }
    if (!told_.empty()) log_info("store", "samples are stored again: " + address_.masked());
    told_.clear();
    return Try::kWritten;
  } catch (const StoreAway& error) {
    close(error);
    return Try::kAway;
  } catch (const StoreBusy& error) {
    close(error);
    return Try::kAway;
  } catch (const StoreError& error) {
    const Try failed = connection_ ? Try::kRefused : Try::kAway;
    close(error);
    return failed;
  }
}

bool Store::Writer::tidy() {
  try {
    if (opened_) open();  // its caller waits for the alarms
    if (!connection_) return false;
    const UtcTime utc = read_clocks().utc;
    const bool tiering = tiers_.step(*connection_, utc);
    return retention_.step(*connection_, steady_now(), utc) || tiering;
  } catch (const StoreError& error) {
    close(error);
    return false;
  }
}

// Reads the alarms before anything of this run is written.
void Store::Writer::open() {
  if (connection_) return;
  auto connection = open_store(address_, IfMissing::kCreate);
  KeptAlarms kept;
  if (opened_) kept = AlarmLifeTable(*connection).kept(read_clocks().utc);
  connection_ = std::move(connection);
  if (told_.empty()) log_info("store", "open: " + address_.masked());
  if (const Opened opened = std::exchange(opened_, {})) opened(kept);
}

void Store::Writer::write_all(const Batch& batch) {
  SqlTransaction transaction(*connection_);
  for (const std::size_t channel : batch.changed) known_.erase(static_cast<std::int64_t>(channel));
  insert(batch.samples.begin(), batch.samples.end());
  insert(batch.events.begin(), batch.events.end());
  transaction.commit();
}

void Store::Writer::write_in_parts(const Batch& batch) {
  SqlTransaction transaction(*connection_);
  insert_in_parts(batch.samples.begin(), batch.samples.end());
  insert_in_parts(batch.events.begin(), batch.events.end());
  QuarantineTable(*connection_).remove_oldest();
  transaction.commit();
}

template <class Row>
void Store::Writer::insert_in_parts(Row begin, Row end) {
  if (begin == end) return;
  connection_->script("savepoint part");
  try {
    insert(begin, end);
    connection_->script("release savepoint part");
    return;
  } catch (const StoreRowRefused& refused) {
    connection_->script("rollback to savepoint part; release savepoint part");
    forget();
    if (end - begin == 1) {
      if constexpr (std::is_same_v<Row, Samples>) {
        quarantine(json_of(channel(begin->channel), *begin), refused.what());
        ++refused_.samples;
      } else {
        quarantine(std::visit([](const auto& record) { return json_of(record); }, *begin),
                   refused.what());
        ++refused_.events;
      }
      return;
    }
  }
  const Row middle = begin + (end - begin) / 2;
  insert_in_parts(begin, middle);
  insert_in_parts(middle, end);
}

// Replaces the index of each sample's channel with the database's number.
void Store::Writer::insert(Samples begin, Samples end) {
  for (Samples at = begin; at != end;) {
    const Samples next = at + std::min<std::ptrdiff_t>(kRowsAtOnce, end - at);
    rows_.assign(at, next);
    at = next;
    std::erase_if(rows_, [this](SampleRow& row) {
      Known& known = known_[row.channel];
      if (known.id == 0) known = ask(static_cast<std::size_t>(row.channel));
      row.channel = known.id;
      row.is_text = known.is_text;
      return row.perhaps_stored && is_stored(row);
    });
    SampleTable(*connection_).insert(rows_);
    tiers_.note(*connection_, rows_);
  }
}

void Store::Writer::insert(Events begin, Events end) {
  for (Events event = begin; event != end; ++event)
    std::visit([&](const auto& record) { insert_event(*connection_, record); }, *event);
}

void Store::Writer::quarantine(const RecordJson& row, const std::string& reason) {
  QuarantineTable(*connection_).insert(read_clocks().utc, row.table, row.content, reason);
  log_counted(LogLevel::kWarning, "store", "rows in quarantine",
              "in quarantine: " + row.table + ' ' + row.content + ": " + reason);
}

Store::Writer::Known Store::Writer::ask(std::size_t index) {
  const StoredChannel known = channel(static_cast<std::int64_t>(index));
  return {SampleTable(*connection_)
              .channel_id(known.bus, known.device, known.channel, known.unit, known.type),
          known.type.starts_with(to_text(ValueType::kString))};
}

bool Store::Writer::is_stored(const SampleRow& row) {
  const auto newest = SampleTable(*connection_).newest(row.channel);
  return newest && newest->is_same(row);
}

StoredChannel Store::Writer::channel(std::int64_t index) const {
  const std::lock_guard lock(mutex_);
  return channels_[static_cast<std::size_t>(index)];
}

void Store::Writer::close(const StoreError& error) {
  if (told_ != error.what()) log_error("store", told_ = error.what());
  connection_.reset();
  forget();  // another file may be there now
}

void Store::Writer::forget() {
  tiers_.reset();
  known_.clear();
}

}  // namespace fieldcast
