#include "tools/station/stream/stream_shared.hpp"

#include <fmt/format.h>

#include "bridge/base/clock.hpp"
#include "bridge/log/log.hpp"
#include "core/base/message_text.hpp"

namespace fieldcast::web {

namespace {

constexpr std::size_t kShown = 120;           // bytes of a subject in the log
constexpr int kMostMessages = 20'000;         // of a subscription, before they are read
constexpr int kMostBytes = 64 * 1024 * 1024;  // the same
constexpr Duration kTryAgain = std::chrono::milliseconds{600};

StreamMessage message_of(natsMsg* message, UtcTime stored_at) {
  return {natsMsg_GetSubject(message),
          {natsMsg_GetData(message), static_cast<std::size_t>(natsMsg_GetDataLength(message))},
          stored_at};
}

UtcTime stored_at_of(natsMsg* message) {
  jsMsgMetaData* data = nullptr;
  if (natsMsg_GetMetaData(&data, message) != NATS_OK) return {};
  const UtcTime at{data->Timestamp};
  jsMsgMetaData_Destroy(data);
  return at;
}

}  // namespace

bool StreamShared::wait(Duration time) {
  std::unique_lock lock(mutex);
  return !ended.wait_for(lock, time, [this] { return ending.load(); });
}

void StreamShared::end() {
  {
    const std::lock_guard lock(mutex);
    ending = true;
  }
  ended.notify_all();
}

void StreamShared::set_fault(StreamPart part, const std::string& fault) {
  {
    const std::lock_guard lock(mutex);
    std::string& known = faults[static_cast<std::size_t>(part)];
    if (known == fault) return;
    known = fault;
  }
  if (!fault.empty())
    log_counted(LogLevel::kWarning, "stream", "faults of streams", fault + "; it is tried again");
}

std::string StreamShared::fault() const {
  const std::lock_guard lock(mutex);
  for (const std::string& fault : faults) {
    if (!fault.empty()) return fault;
  }
  return {};
}

void MessageReader::refuse(const StreamMessage& message, DecodeFault fault) {
  if (!counts_) return;
  ++shared_.refused;
  if (const auto subject = stream_subject_from(message.subject))
    shared_.sites.refused(subject->site);
  log_counted(LogLevel::kWarning, "stream", "messages that were skipped",
              fmt::format("{}: a message of {} bytes is skipped: {}",
                          printable(std::string(message.subject), kShown), message.data.size(),
                          to_text(fault)));
}

bool MessageReader::is_taken(const StreamMessage& message) const {
  const auto subject = stream_subject_from(message.subject);
  return subject && shared_.sites.is_reserved(subject->site);
}

std::optional<StreamBatch> MessageReader::batch_of(natsMsg* from) {
  const StreamMessage message = message_of(from, stored_at_of(from));
  is_unavailable_ = false;
  if (is_taken(message)) {
    refuse(message, DecodeFault::kTaken);
    return std::nullopt;
  }
  const auto find = [this](const std::string& site, const std::string& bus,
                           const std::string& device, std::uint64_t identity) {
    return shared_.catalogues.find(
        site, bus, device, identity, steady_now(), [this](const std::string& key) {
          auto entry = session_.entry(shared_.spec.bucket, key);
          is_unavailable_ = !entry && entry.error() == EntryFault::kUnavailable;
          return entry;
        });
  };
  auto batch = decode_batch(message, find);
  const Instant began = steady_now();
  if (!batch && batch.error() == DecodeFault::kCatalogue &&
      began >= waited_[std::string(message.subject)]) {
    if (waited_.size() >= kMaxWaited) waited_.clear();
    while (!batch && batch.error() == DecodeFault::kCatalogue && steady_now() - began < kWait &&
           shared_.wait(kTryAgain))
      batch = decode_batch(message, find);
    waited_[std::string(message.subject)] = steady_now() + kWaitAgain;
  }
  if (!batch) {
    is_unavailable_ =
        batch.error() == DecodeFault::kCatalogue && (is_unavailable_ || shared_.is_ending());
    if (!is_unavailable_) refuse(message, batch.error());
    return std::nullopt;
  }
  shared_.sites.heard(batch->site, batch->stored_at);
  return *std::move(batch);
}

std::optional<StationAlarmStatus> MessageReader::alarm_of(natsMsg* from) {
  const StreamMessage message = message_of(from, stored_at_of(from));
  auto alarm = is_taken(message) ? tl::make_unexpected(DecodeFault::kTaken) : decode_alarm(message);
  if (alarm) {
    const std::string& bus = alarm->alarm.bus;
    shared_.sites.heard(bus.substr(0, bus.find(':')), message.stored_at);
    return *std::move(alarm);
  }
  refuse(message, alarm.error());
  return std::nullopt;
}

tl::expected<forward::NatsSubscription, std::string> subscribe_in_order(NatsSession& session,
                                                                        const std::string& stream,
                                                                        const char* subjects,
                                                                        StartWith start) {
  jsSubOptions options;
  jsSubOptions_Init(&options);
  options.Stream = stream.c_str();
  options.Ordered = true;
  options.Config.DeliverPolicy =
      start == StartWith::kAll ? js_DeliverAll : js_DeliverLastPerSubject;
  natsSubscription* made = nullptr;
  jsErrCode code{};
  const natsStatus status =
      js_SubscribeSync(&made, session.context(), subjects, nullptr, &options, &code);
  if (status != NATS_OK) {
    const char* const detail = nats_GetLastError(nullptr);
    return tl::make_unexpected(
        fmt::format("stream {} cannot be read: {}", stream,
                    detail == nullptr ? natsStatus_GetText(status) : detail));
  }
  forward::NatsSubscription subscription(made);
  (void)natsSubscription_SetPendingLimits(made, kMostMessages, kMostBytes);
  return subscription;
}

}  // namespace fieldcast::web
