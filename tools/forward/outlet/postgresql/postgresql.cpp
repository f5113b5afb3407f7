#include "tools/forward/outlet/postgresql/postgresql.hpp"

#include <fmt/format.h>

#include <unordered_map>
#include <utility>

#include "bridge/log/log.hpp"
#include "bridge/process/secret.hpp"
#include "tools/forward/outlet/postgresql/connection_text.hpp"
#include "tools/forward/outlet/postgresql/tables.hpp"
#include "tools/forward/outlet/undecodable.hpp"
#include "tools/forward/payload/codec.hpp"

namespace fieldcast::forward {

namespace {

constexpr const char* kSubject = "postgresql";

}  // namespace

PostgresqlOutlet::Statements::Statements(const std::string& schema)
    : upsert_channels(forward::upsert_channels(schema)),
      insert_channels(forward::insert_channels(schema)),
      select_channels(forward::select_channels(schema)),
      insert_samples(forward::insert_samples(schema)),
      insert_alarm(forward::insert_alarm(schema)),
      insert_audit(forward::insert_audit(schema)) {}

PostgresqlOutlet::PostgresqlOutlet(const PostgresqlSpec& spec, OutletContext context)
    : spec_(spec),
      context_(std::move(context)),
      statements_(spec.schema),
      decoder_(context_.catalogue) {}

bool PostgresqlOutlet::is_ready(Instant now) {
  if (now < next_attempt_) return false;
  if (connection_) return true;
  next_attempt_ = now + kPause;
  try {
    connect();
  } catch (const StoreError& error) {
    log_counted(LogLevel::kWarning, kSubject, "failed connections",
                fmt::format("cannot connect: {}; the forwarder tries again", error.what()));
    connection_.reset();
  }
  if (connection_) next_attempt_ = {};
  return connection_ != nullptr;
}

void PostgresqlOutlet::connect() {
  auto text = connection_text(spec_);
  if (!text) throw StoreError(text.error());
  const StoreAddress address(*text);
  wipe(*text);
  connection_ = open_postgres(address);
  forget();
  if (spec_.create) connection_->script(create_tables(spec_.schema));
  log_info(kSubject, fmt::format("connected to {}, database {}", spec_.server, spec_.database));
}

std::optional<std::size_t> PostgresqlOutlet::send(const Record& record) {
  if (pending_samples_ >= kMostSamples) return std::nullopt;  // after the next flush()
  pending_.push_back(record);
  pending_samples_ += record.samples;
  return record.body.size();
}

void PostgresqlOutlet::flush() {
  if (pending_.empty()) return;
  try {
    const auto written = write(pending_);
    results_.insert(results_.end(), written.begin(), written.end());
  } catch (const StoreRowRefused&) { write_each(); } catch (const StoreError& error) {
    fail_pending(error);
  }
  pending_.clear();
  pending_samples_ = 0;
  context_.wake();
}

std::vector<OutletResult> PostgresqlOutlet::write(std::span<const Record> records) {
  std::vector<OutletResult> results;
  SqlTransaction transaction(*connection_);
  SampleRows samples;
  for (const Record& record : records) {
    const bool is_decoded = write(record, samples);
    if (!is_decoded) log_undecodable(record);
    results.push_back({record.id, is_decoded ? Outcome::kAcknowledged : Outcome::kRefused});
  }
  if (samples.size() > 0) connection_->execute(statements_.insert_samples, samples.parameters());
  transaction.commit();
  return results;
}

bool PostgresqlOutlet::write(const Record& record, SampleRows& samples) {
  switch (record.kind) {
    case RecordKind::kAlarm: {
      const auto alarm = decode_alarm(record.body);
      if (alarm)
        connection_->execute(
            statements_.insert_alarm,
            alarm_parameters(context_.site, *alarm, record.identity ^ record.epoch));
      return alarm.has_value();
    }
    case RecordKind::kAudit: {
      const auto entry = decode_audit(record.body);
      if (entry)
        connection_->execute(statements_.insert_audit, audit_parameters(context_.site, *entry));
      return entry.has_value();
    }
    case RecordKind::kCatalogue: {
      const auto catalogue = decode_catalogue(record.body);
      if (catalogue) static_cast<void>(ids_of(record, record.identity, *catalogue));
      return catalogue.has_value();
    }
    case RecordKind::kSamples: break;
  }
  const auto decoded = decoder_.samples(record);
  if (decoded)
    samples.add(decoded->batch, ids_of(record, decoded->batch.catalogue, *decoded->catalogue));
  return decoded.has_value();
}

void PostgresqlOutlet::write_each() {
  forget();  // the transaction was rolled back
  std::vector<Record> records = std::exchange(pending_, {});
  for (std::size_t i = 0; i < records.size(); ++i) {
    try {
      results_.push_back(write(std::span(&records[i], 1)).front());
    } catch (const StoreRowRefused& error) {
      forget();
      log_counted(LogLevel::kError, kSubject, "messages that the server refuses",
                  fmt::format("{}/{}: a message with {} samples is removed: {}", records[i].bus,
                              records[i].device, records[i].samples, error.what()));
      results_.push_back({records[i].id, Outcome::kRefused});
    } catch (const StoreError& error) {
      pending_.assign(records.begin() + static_cast<std::ptrdiff_t>(i), records.end());
      return fail_pending(error);
    }
  }
}

void PostgresqlOutlet::forget() {
  ids_.clear();
  present_.clear();
}

const std::vector<std::int64_t>& PostgresqlOutlet::ids_of(const Record& record,
                                                          std::uint64_t identity,
                                                          const DeviceCatalogue& catalogue) {
  if (ids_.size() >= kMaxCatalogues) forget();
  const auto known = ids_.find(identity);
  std::uint64_t& present = present_[catalogue.bus + '/' + catalogue.device];
  if (known != ids_.end() && (record.is_late || present == identity)) return known->second;
  connection_->execute(record.is_late ? statements_.insert_channels : statements_.upsert_channels,
                       channel_parameters(context_.site, catalogue));
  if (!record.is_late) present = identity;
  std::unordered_map<std::string, std::int64_t> by_name;
  connection_->query(statements_.select_channels, {context_.site, catalogue.bus, catalogue.device},
                     [&by_name](const SqlRow& row) {
                       by_name[text_at(row, 0)] = integer_at(row, 1);
                       return true;
                     });
  std::vector<std::int64_t> ids;
  for (const StationChannel& channel : catalogue.channels) ids.push_back(by_name[channel.channel]);
  return ids_[identity] = std::move(ids);
}

void PostgresqlOutlet::fail_pending(const StoreError& error) {
  log_counted(LogLevel::kWarning, kSubject, "messages that could not be written",
              fmt::format("{}; they are sent again", error.what()));
  for (const Record& record : pending_) results_.push_back({record.id, Outcome::kFailed});
  connection_.reset();
  next_attempt_ = {};
}

std::vector<OutletResult> PostgresqlOutlet::take_results() { return std::exchange(results_, {}); }

}  // namespace fieldcast::forward
