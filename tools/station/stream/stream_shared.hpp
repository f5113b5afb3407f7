// What the threads of a StreamReader share. Any thread.
#pragma once

#include <array>
#include <atomic>
#include <condition_variable>
#include <cstdint>
#include <functional>
#include <mutex>
#include <optional>
#include <string>
#include <unordered_map>

#include "bridge/store/store.hpp"
#include "tools/forward/outlet/nats/nats_handles.hpp"
#include "tools/station/stream/catalogue_cache.hpp"
#include "tools/station/stream/message_decoder.hpp"
#include "tools/station/stream/nats_session.hpp"
#include "tools/station/stream/site_registry.hpp"

namespace fieldcast::web {

enum class StreamPart : std::uint8_t { kState, kLive, kRecord };
inline constexpr std::size_t kStreamParts = 3;

struct StreamShared {
  forward::JetStreamSpec spec;
  std::string station;  // its name
  StoreAddress store;   // of the record
  std::atomic<bool> commands = false;

  CatalogueCache catalogues;
  SiteRegistry sites;
  std::atomic<std::uint64_t> messages = 0;                // with samples, that were decoded
  std::atomic<std::uint64_t> refused = 0;                 // that could not be decoded
  std::atomic<std::uint64_t> recorded = 0, repeated = 0;  // of the record

  // Returns false if the reader ends.
  [[nodiscard]] bool wait(Duration time);
  [[nodiscard]] bool is_ending() const { return ending; }
  void end();

  // Why a part cannot read its stream; empty: it can.
  void set_fault(StreamPart part, const std::string& fault);
  [[nodiscard]] std::string fault() const;

  std::atomic<bool> ending = false;
  mutable std::mutex mutex;  // of the members below
  std::condition_variable ended;
  std::array<std::string, kStreamParts> faults;
};

// Decodes the messages of one thread.
class MessageReader {
 public:
  // How long a message waits for its catalogue, once for each device in kWaitAgain.
  static constexpr Duration kWait = std::chrono::seconds{3};
  static constexpr Duration kWaitAgain = std::chrono::minutes{10};
  static constexpr std::size_t kMaxWaited = 100'000;

  // `counts`: counts and logs the messages that cannot be decoded.
  MessageReader(StreamShared& shared, NatsSession& session, bool counts)
      : shared_(shared), session_(session), counts_(counts) {}

  // Empty for a message that cannot be decoded. May block while it waits for a catalogue.
  [[nodiscard]] std::optional<StreamBatch> batch_of(natsMsg* message);
  // Whether the last batch is empty only because its catalogue could not be read now.
  [[nodiscard]] bool is_unavailable() const { return is_unavailable_; }
  [[nodiscard]] std::optional<StationAlarmStatus> alarm_of(natsMsg* message);

 private:
  void refuse(const StreamMessage& message, DecodeFault fault);
  [[nodiscard]] bool is_taken(const StreamMessage& message) const;

  StreamShared& shared_;
  NatsSession& session_;
  const bool counts_;
  bool is_unavailable_ = false;
  std::unordered_map<std::string, Instant> waited_;  // when it may wait again, by subject
};

// The thread functions. They return when the reader ends.
class DomainInbox;
class Recorder;
void run_live(StreamShared& shared, DomainInbox& inbox, bool counts);
void run_record(StreamShared& shared, Store& store);
void run_state(StreamShared& shared, DomainInbox& inbox, Recorder* recorder,
               const std::function<void(const StationAlarmStatus&)>& on_alarm);

// A consumer of one thread that delivers in order from the last message of each subject, or all.
enum class StartWith : std::uint8_t { kLastOfEachSubject, kAll };
[[nodiscard]] tl::expected<forward::NatsSubscription, std::string> subscribe_in_order(
    NatsSession& session, const std::string& stream, const char* subjects, StartWith start);

}  // namespace fieldcast::web
