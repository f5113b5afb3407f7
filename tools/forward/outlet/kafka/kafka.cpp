#include "tools/forward/outlet/kafka/kafka.hpp"

#include <fmt/format.h>

#include <array>
#include <unordered_set>
#include <utility>

#include "bridge/log/log.hpp"
#include "tools/forward/outlet/kafka/kafka_messages.hpp"
#include "tools/forward/outlet/kafka/kafka_options.hpp"
#include "tools/forward/outlet/message_id.hpp"
#include "tools/forward/outlet/undecodable.hpp"

namespace fieldcast::forward {

namespace {

constexpr const char* kSubject = "kafka";
constexpr Duration kPause = std::chrono::seconds{2};  // after a failed attempt
constexpr int kConnectMs = 3'000;

// Errors that a repetition does not change.
bool is_refusal(rd_kafka_resp_err_t error) {
  return error == RD_KAFKA_RESP_ERR_MSG_SIZE_TOO_LARGE ||
         error == RD_KAFKA_RESP_ERR_RECORD_LIST_TOO_LARGE ||
         error == RD_KAFKA_RESP_ERR_INVALID_RECORD || error == RD_KAFKA_RESP_ERR_POLICY_VIOLATION;
}

bool is_missing_topic(rd_kafka_resp_err_t error) {
  return error == RD_KAFKA_RESP_ERR_UNKNOWN_TOPIC_OR_PART ||
         error == RD_KAFKA_RESP_ERR__UNKNOWN_TOPIC;
}

void log_refused(const std::string& topic, std::size_t bytes, rd_kafka_resp_err_t error) {
  log_counted(LogLevel::kError, kSubject, "messages that the server refuses",
              fmt::format("topic {}: a message of {} bytes is removed: {}", topic, bytes,
                          rd_kafka_err2str(error)));
}

void log_failed(const std::string& topic, rd_kafka_resp_err_t error) {
  log_counted(
      LogLevel::kWarning, kSubject, "messages without an acknowledgement",
      fmt::format("topic {}: {}; the message is sent again{}", topic, rd_kafka_err2str(error),
                  is_missing_topic(error) ? "; create the topic" : ""));
}

// Null if there is no memory.
rd_kafka_headers_t* headers_of(const std::string& site, const Record& record) {
  rd_kafka_headers_t* const headers = rd_kafka_headers_new(4);
  const std::string id = message_id_of(site, record);
  for (const auto& [name, value] : {std::pair<const char*, const std::string&>{"id", id},
                                    {"site", site},
                                    {"bus", record.bus},
                                    {"device", record.device}})
    rd_kafka_header_add(headers, name, -1, value.data(), static_cast<ssize_t>(value.size()));
  return headers;
}

}  // namespace

struct KafkaOutlet::State {
  State(const KafkaSpec& spec_of_outlet, OutletContext context_of_outlet)
      : spec(spec_of_outlet),
        context(std::move(context_of_outlet)),
        payloads(context.site, context.payload, context.catalogue) {}

  const KafkaSpec spec;
  const OutletContext context;
  PayloadMaker payloads;
  bool is_down = false;   // no broker is reachable
  bool is_fatal = false;  // the producer must be replaced
  std::string last_error;
  Instant next_attempt{};
  std::unordered_set<std::uint64_t> pending;  // records
  std::vector<OutletResult> results;
  KafkaProducer producer;  // last: its callbacks use the members above

  void connect(Instant now);
  void disconnect();
  void finish(std::uint64_t record, Outcome outcome);

  static void on_delivery(rd_kafka_t* from, const rd_kafka_message_t* message, void* closure);
  static void on_error(rd_kafka_t* from, int error, const char* reason, void* closure);
  static void on_queued(rd_kafka_t* from, void* closure);
};

void KafkaOutlet::State::on_delivery(rd_kafka_t*, const rd_kafka_message_t* message,
                                     void* closure) {
  auto& self = *static_cast<State*>(closure);
  const auto record = reinterpret_cast<std::uintptr_t>(message->_private);
  const std::string topic = rd_kafka_topic_name(message->rkt);
  if (message->err == RD_KAFKA_RESP_ERR_NO_ERROR) {
    self.is_down = false;
    self.finish(record, Outcome::kAcknowledged);
  } else if (is_refusal(message->err)) {
    log_refused(topic, message->len, message->err);
    self.finish(record, Outcome::kRefused);
  } else {
    log_failed(topic, message->err);
    self.finish(record, Outcome::kFailed);
  }
}

void KafkaOutlet::State::on_error(rd_kafka_t* from, int error, const char* reason, void* closure) {
  auto& self = *static_cast<State*>(closure);
  const auto code = static_cast<rd_kafka_resp_err_t>(error);
  if (code == RD_KAFKA_RESP_ERR__FATAL) {
    std::array<char, 512> text{};
    rd_kafka_fatal_error(from, text.data(), text.size());
    self.last_error = text.data();
    self.is_fatal = true;
  } else if (code == RD_KAFKA_RESP_ERR__ALL_BROKERS_DOWN) {
    self.is_down = true;
    return;  // the reason was an error before
  } else {
    self.last_error = reason;
  }
  log_counted(LogLevel::kWarning, kSubject, rd_kafka_err2name(code), self.last_error);
}

// On a thread of the library.
void KafkaOutlet::State::on_queued(rd_kafka_t*, void* closure) {
  static_cast<State*>(closure)->context.wake();
}

void KafkaOutlet::State::finish(std::uint64_t record, Outcome outcome) {
  if (pending.erase(record) > 0) results.push_back({record, outcome});
}

void KafkaOutlet::State::connect(Instant now) {
  next_attempt = now + kPause;
  auto conf = kafka_options(spec, "fieldcast-forward-" + context.site);
  if (!conf) {
    log_counted(LogLevel::kError, kSubject, "faults of the login", conf.error());
    return;
  }
  rd_kafka_conf_set_opaque(conf->get(), this);
  rd_kafka_conf_set_dr_msg_cb(conf->get(), on_delivery);
  rd_kafka_conf_set_error_cb(conf->get(), on_error);
  rd_kafka_conf_set_log_cb(conf->get(), [](const rd_kafka_t*, int, const char*, const char*) {});
  std::array<char, 256> text{};
  rd_kafka_t* const made = rd_kafka_new(RD_KAFKA_PRODUCER, conf->get(), text.data(), text.size());
  if (made == nullptr) {
    log_counted(LogLevel::kError, kSubject, "faults of the configuration", text.data());
    return;
  }
  static_cast<void>(conf->release());  // the producer owns it
  producer.reset(made);
  is_down = is_fatal = false;
  last_error.clear();
  const rd_kafka_metadata_t* metadata = nullptr;
  const rd_kafka_resp_err_t error = rd_kafka_metadata(made, 0, nullptr, &metadata, kConnectMs);
  if (error != RD_KAFKA_RESP_ERR_NO_ERROR) {
    rd_kafka_poll(made, 0);  // the reason
    log_counted(LogLevel::kWarning, kSubject, "failed connections",
                fmt::format("cannot connect: {}; the forwarder tries again",
                            last_error.empty() ? rd_kafka_err2str(error) : last_error.c_str()));
    producer.reset();
    return;
  }
  log_info(kSubject, fmt::format("connected to a cluster with {} brokers", metadata->broker_cnt));
  rd_kafka_metadata_destroy(metadata);
  rd_kafka_queue_t* const queue = rd_kafka_queue_get_main(made);
  rd_kafka_queue_cb_event_enable(queue, on_queued, this);
  rd_kafka_queue_destroy(queue);
  is_down = false;
}

void KafkaOutlet::State::disconnect() {
  if (!producer) return;
  log_warning(kSubject, fmt::format("disconnected ({}); the queue keeps all records", last_error));
  producer.reset();
  for (const std::uint64_t record : pending) results.push_back({record, Outcome::kFailed});
  pending.clear();
}

KafkaOutlet::KafkaOutlet(const KafkaSpec& spec, OutletContext context)
    : state_(new State(spec, std::move(context))) {}

KafkaOutlet::~KafkaOutlet() = default;

bool KafkaOutlet::is_ready(Instant now) {
  State& state = *state_;
  if (state.producer) rd_kafka_poll(state.producer.get(), 0);
  if (state.is_fatal || (state.is_down && state.pending.empty())) state.disconnect();
  if (!state.producer && now >= state.next_attempt) state.connect(now);
  return state.producer != nullptr;
}

std::optional<std::size_t> KafkaOutlet::send(const Record& record) {
  State& state = *state_;
  if (state.is_down) return std::nullopt;
  const auto payload = state.payloads.payload_of(record);
  if (!payload) {
    log_undecodable(record);
    state.results.push_back({record.id, Outcome::kRefused});
    return 0;
  }
  const std::string& topic = topic_of(state.spec.topics, record);
  const std::string key = key_of(state.context.site, record);
  rd_kafka_headers_t* const headers = headers_of(state.context.site, record);
  const rd_kafka_resp_err_t error = rd_kafka_producev(
      state.producer.get(), RD_KAFKA_V_TOPIC(topic.c_str()), RD_KAFKA_V_KEY(key.data(), key.size()),
      RD_KAFKA_V_VALUE(const_cast<char*>(payload->data()), payload->size()),
      RD_KAFKA_V_MSGFLAGS(RD_KAFKA_MSG_F_COPY), RD_KAFKA_V_HEADERS(headers),
      RD_KAFKA_V_OPAQUE(reinterpret_cast<void*>(static_cast<std::uintptr_t>(record.id))),
      RD_KAFKA_V_END);
  if (error == RD_KAFKA_RESP_ERR_NO_ERROR) {
    state.pending.insert(record.id);
    return payload->size() + key.size();
  }
  rd_kafka_headers_destroy(headers);
  if (is_refusal(error)) {
    log_refused(topic, payload->size(), error);
    state.results.push_back({record.id, Outcome::kRefused});
    return 0;
  }
  log_failed(topic, error);
  return std::nullopt;
}

std::vector<OutletResult> KafkaOutlet::take_results() {
  if (state_->producer) rd_kafka_poll(state_->producer.get(), 0);
  return std::exchange(state_->results, {});
}

}  // namespace fieldcast::forward
