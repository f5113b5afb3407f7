#include "tools/station/stream/nats_session.hpp"

#include <string_view>
#include <utility>

#include "bridge/log/log.hpp"
#include "tools/forward/outlet/nats/nats_options.hpp"

namespace fieldcast::web {

namespace {

constexpr Duration kConnectPause = std::chrono::seconds{2};  // after a failed attempt

std::string value_of(kvEntry* entry) {
  return {static_cast<const char*>(kvEntry_Value(entry)),
          static_cast<std::size_t>(kvEntry_ValueLen(entry))};
}

}  // namespace

NatsSession::NatsSession(const forward::JetStreamSpec& spec, std::string name, bool logs)
    : spec_(spec), name_(std::move(name)), logs_(logs) {}

NatsSession::~NatsSession() { disconnect(); }

void NatsSession::disconnect() {
  buckets_.clear();
  context_.reset();
  if (connection_) natsConnection_Close(connection_.get());
  connection_.reset();
}

void NatsSession::report(const std::string& fault) {
  if (fault == fault_) return;
  fault_ = fault;
  if (logs_ && !fault.empty())
    log_counted(LogLevel::kWarning, "stream", "failed connections",
                fault + "; the station goes on and tries again");
}

void NatsSession::connect() {
  auto options = forward::nats_options(spec_, name_);
  if (!options) return report(options.error());
  natsConnection* made = nullptr;
  if (const natsStatus status = natsConnection_Connect(&made, options->get()); status != NATS_OK) {
    const char* const detail = nats_GetLastError(nullptr);
    return report(std::string("cannot connect: ") +
                  (detail == nullptr ? natsStatus_GetText(status) : detail));
  }
  connection_.reset(made);
  jsCtx* context = nullptr;
  if (natsConnection_JetStream(&context, made, nullptr) != NATS_OK) {
    disconnect();
    return report("the library cannot create a context of JetStream");
  }
  context_.reset(context);
}

bool NatsSession::is_ready(Instant now) {
  // The library gives a connection up after repeated refusals of the login.
  if (connection_ && natsConnection_IsClosed(connection_.get())) {
    report("disconnected: " + forward::reason_of(connection_.get()));
    disconnect();
    next_attempt_ = now + kConnectPause;
  }
  if (!connection_ && now >= next_attempt_) {
    next_attempt_ = now + kConnectPause;
    connect();
  }
  const bool ready =
      connection_ && natsConnection_Status(connection_.get()) == NATS_CONN_STATUS_CONNECTED;
  if (ready == was_ready_) return ready;
  was_ready_ = ready;
  if (ready) {
    ++generation_;
    buckets_.clear();
    fault_.clear();
    if (logs_) log_info("stream", "connected to " + forward::server_of(connection_.get()));
  } else if (connection_) {
    report("disconnected: " + forward::reason_of(connection_.get()));
  }
  return ready;
}

kvStore* NatsSession::bucket(const std::string& name) {
  forward::NatsBucket& known = buckets_[name];
  if (known == nullptr) {
    kvStore* made = nullptr;
    if (js_KeyValue(&made, context_.get(), name.c_str()) == NATS_OK) known.reset(made);
  }
  return known.get();
}

void NatsSession::acknowledge(const std::vector<std::string>& replies) {
  constexpr std::string_view kAcknowledged = "+ACK";
  constexpr std::int64_t kFlushMs = 2'000;
  if (!connection_) return;
  for (const std::string& reply : replies)
    (void)natsConnection_Publish(connection_.get(), reply.c_str(), kAcknowledged.data(),
                                 static_cast<int>(kAcknowledged.size()));
  (void)natsConnection_FlushTimeout(connection_.get(), kFlushMs);
}

tl::expected<std::string, EntryFault> NatsSession::entry(const std::string& name,
                                                         const std::string& key) {
  kvStore* const store = bucket(name);
  if (store == nullptr) return tl::make_unexpected(EntryFault::kUnavailable);
  kvEntry* made = nullptr;
  const natsStatus status = kvStore_Get(&made, store, key.c_str());
  if (status != NATS_OK)
    return tl::make_unexpected(status == NATS_NOT_FOUND ? EntryFault::kMissing
                                                        : EntryFault::kUnavailable);
  const forward::NatsEntry entry(made);
  return value_of(made);
}

void NatsSession::each_entry(
    const std::string& name,
    const std::function<bool(const std::string& key, const std::string& value)>& on_entry) {
  constexpr std::int64_t kNextMs = 2'000;
  kvStore* const store = bucket(name);
  kvWatchOptions options;
  kvWatchOptions_Init(&options);
  options.IgnoreDeletes = true;
  kvWatcher* made = nullptr;
  if (store == nullptr || kvStore_WatchAll(&made, store, &options) != NATS_OK) return;
  const forward::NatsWatcher watcher(made);
  while (true) {
    kvEntry* next = nullptr;
    if (kvWatcher_Next(&next, made, kNextMs) != NATS_OK || next == nullptr) return;
    const forward::NatsEntry entry(next);
    if (!on_entry(kvEntry_Key(next), value_of(next))) return;
  }
}

}  // namespace fieldcast::web
