// The thread that records all samples of the stream, late ones too. The server keeps its position:
// a message is acknowledged after the store has committed it, so that a restarted station
// continues with the first message that is not stored.
#include <fmt/format.h>

#include <string>
#include <vector>

#include "bridge/base/clock.hpp"
#include "bridge/log/log.hpp"
#include "bridge/store/store.hpp"
#include "tools/forward/outlet/nats/subject.hpp"
#include "tools/station/stream/stream_recorder.hpp"
#include "tools/station/stream/stream_shared.hpp"

namespace fieldcast::web {

namespace {

constexpr Duration kRecordPause = std::chrono::seconds{1};  // before a further attempt
constexpr int kFetched = 256;                               // messages of one request
constexpr std::int64_t kFetchMs = 500;
constexpr std::int64_t kMaxUnacknowledged = 20'000;
// Then the server delivers a message again that was not acknowledged, for example because this
// station was killed.
constexpr Duration kRedelivered = std::chrono::seconds{15};
// The store is committed, and messages are acknowledged, after this time or number of rows.
constexpr Duration kCommit = std::chrono::milliseconds{500};
constexpr std::size_t kCommitRows = 50'000;
constexpr Duration kFlush = std::chrono::seconds{2};

using Subscribed = tl::expected<forward::NatsSubscription, std::string>;

std::string last_error(natsStatus status) {
  const char* const detail = nats_GetLastError(nullptr);
  return detail == nullptr ? natsStatus_GetText(status) : detail;
}

// The consumer is made with the first start, at the begin of the stream.
Subscribed subscribe(NatsSession& session, const StreamShared& shared) {
  const std::string& stream = shared.spec.sample_stream;
  const std::string name = "station-" + forward::subject_token(shared.station);
  jsConsumerInfo* info = nullptr;
  natsStatus status =
      js_GetConsumerInfo(&info, session.context(), stream.c_str(), name.c_str(), nullptr, nullptr);
  jsConsumerInfo_Destroy(info);
  if (status != NATS_OK) {
    jsConsumerConfig config;
    jsConsumerConfig_Init(&config);
    config.Durable = name.c_str();
    config.DeliverPolicy = js_DeliverAll;
    // Each one: a message that was sent but not received must not be acknowledged with a later one.
    config.AckPolicy = js_AckExplicit;
    config.AckWait = Duration{kRedelivered}.count();
    config.MaxAckPending = kMaxUnacknowledged;
    status = js_AddConsumer(nullptr, session.context(), stream.c_str(), &config, nullptr, nullptr);
    if (status != NATS_OK)
      return tl::make_unexpected(fmt::format("stream {}: the consumer {} cannot be created: {}",
                                             stream, name, last_error(status)));
  }
  jsSubOptions options;
  jsSubOptions_Init(&options);
  options.Stream = stream.c_str();
  options.Consumer = name.c_str();
  natsSubscription* made = nullptr;
  status =
      js_PullSubscribe(&made, session.context(), ">", name.c_str(), nullptr, &options, nullptr);
  if (status != NATS_OK)
    return tl::make_unexpected(fmt::format("stream {}: the consumer {} cannot be read: {}", stream,
                                           name, last_error(status)));
  return forward::NatsSubscription(made);
}

class RecordReader {
 public:
  RecordReader(StreamShared& shared, Store& store)
      : shared_(shared),
        store_(store),
        session_(shared.spec, "fieldcast-station " + shared.station + " record", false),
        reader_(shared, session_, true),
        recorder_(store) {}

  void run() {
    while (!shared_.is_ending()) {
      if (!is_subscribed()) continue;
      fetch();
      const Instant now = steady_now();
      if (rows_ >= kCommitRows || now - committed_ >= kCommit) commit();
    }
    commit();
  }

 private:
  // Waits a moment if it is not.
  bool is_subscribed() {
    if (!session_.is_ready(steady_now())) {
      (void)shared_.wait(std::chrono::milliseconds{kFetchMs});
      return false;
    }
    if (subscription_ != nullptr && generation_ == session_.generation()) return true;
    subscription_.reset();
    auto made = subscribe(session_, shared_);
    shared_.set_fault(StreamPart::kRecord, made ? "" : made.error());
    if (!made) {
      (void)shared_.wait(kRecordPause);
      return false;
    }
    subscription_ = *std::move(made);
    generation_ = session_.generation();
    return true;
  }

  void fetch() {
    natsMsgList list{};
    const natsStatus status =
        natsSubscription_Fetch(&list, subscription_.get(), kFetched, kFetchMs, nullptr);
    if (status != NATS_OK && status != NATS_TIMEOUT) {
      subscription_.reset();
      (void)shared_.wait(kRecordPause);
      return;
    }
    for (int i = 0; i < list.Count && !shared_.is_ending(); ++i) {
      if (const auto batch = reader_.batch_of(list.Msgs[i])) record(*batch);
      if (reader_.is_unavailable()) continue;  // not acknowledged: it is delivered again
      if (const char* const reply = natsMsg_GetReply(list.Msgs[i])) done_.emplace_back(reply);
    }
    natsMsgList_Destroy(&list);
  }

  void record(const StreamBatch& batch) {
    // The store drops samples that do not fit its queue.
    while (store_.counters().waiting > Store::kMaxWaiting / 2 && !shared_.is_ending())
      (void)store_.flush(kFlush);
    rows_ += recorder_.record(batch);
    shared_.recorded = recorder_.counters().recorded;
    shared_.repeated = recorder_.counters().repeated;
  }

  // While the database is not available, no message is acknowledged and no further one is fetched.
  void commit() {
    if (done_.empty()) return;
    while (!store_.flush(kFlush)) {
      if (shared_.is_ending()) return;
    }
    note_late();
    session_.acknowledge(done_);
    done_.clear();
    rows_ = 0;
    committed_ = steady_now();
  }

  // What cannot be stored is only missing as a mark: the samples are there.
  void note_late() {
    const std::vector<StreamRecorder::Late> late = recorder_.take_late();
    if (late.empty()) return;
    try {
      const auto connection = open_store(shared_.store, IfMissing::kCreate);
      for (const auto& [bus, device, range] : late) LateTable(*connection).add(bus, device, range);
    } catch (const StoreError& error) {
      log_counted(LogLevel::kWarning, "stream", "marks of late samples that were not stored",
                  error.what());
    }
  }

  StreamShared& shared_;
  Store& store_;
  NatsSession session_;
  MessageReader reader_;
  StreamRecorder recorder_;
  forward::NatsSubscription subscription_;
  // Reply subjects of messages that were recorded and not acknowledged yet, at most
  // kMaxUnacknowledged: the server sends no further one.
  std::vector<std::string> done_;
  std::uint64_t generation_ = 0;
  std::size_t rows_ = 0;  // since the last commit
  Instant committed_{};
};

}  // namespace

void run_record(StreamShared& shared, Store& store) { RecordReader(shared, store).run(); }

}  // namespace fieldcast::web
