#include "tools/forward/outlet/nats/jetstream.hpp"

#include <fmt/format.h>

#include <atomic>
#include <mutex>
#include <unordered_map>
#include <utility>

#include "bridge/log/log.hpp"
#include "tools/forward/outlet/message_id.hpp"
#include "tools/forward/outlet/nats/nats_options.hpp"
#include "tools/forward/outlet/nats/streams.hpp"
#include "tools/forward/outlet/nats/subject.hpp"
#include "tools/forward/outlet/undecodable.hpp"

namespace fieldcast::forward {

namespace {

constexpr const char* kSubject = "jetstream";
constexpr Duration kPause = std::chrono::seconds{2};  // after a failed attempt
// The library reconnects by itself, but it waits by the system clock: after a step back, for as
// long as the step. Then a new connection is made.
constexpr Duration kPatience = std::chrono::seconds{15};
constexpr std::int64_t kCloseMs = 5'000;
constexpr std::size_t kMaxRequest = 64 * 1024;  // bytes of a command that are kept

Outcome outcome_of(const jsPubAck* done, const jsPubAckErr* error) {
  if (done != nullptr) return Outcome::kAcknowledged;
  const bool is_too_large = error != nullptr && error->ErrCode == JSStreamMessageExceedsMaximumErr;
  return is_too_large ? Outcome::kRefused : Outcome::kFailed;
}

void log_refused(std::string_view subject, std::size_t bytes, std::string_view limit) {
  log_counted(LogLevel::kError, kSubject, "messages that the server refuses",
              fmt::format("{}: a message of {} bytes is removed: it exceeds {}; increase it",
                          subject, bytes, limit));
}

void log_failed(std::string_view subject, const jsPubAckErr* error) {
  const natsStatus status = error == nullptr ? NATS_ERR : error->Err;
  const bool has_text = error != nullptr && error->ErrText != nullptr && *error->ErrText != '\0';
  log_counted(LogLevel::kWarning, kSubject, "messages without an acknowledgement",
              fmt::format("{}: {}; the message is sent again{}", subject,
                          has_text ? error->ErrText : natsStatus_GetText(status),
                          status == NATS_NO_RESPONDERS
                              ? "; no stream has this subject: create it, or set create: true"
                              : ""));
}

}  // namespace

// Lives until the library has ended its threads: its callbacks use this object.
struct JetStreamOutlet::State {
  State(const JetStreamSpec& spec_of_outlet, OutletContext context_of_outlet)
      : spec(spec_of_outlet),
        context_of(std::move(context_of_outlet)),
        payloads(context_of.site, context_of.payload, context_of.catalogue) {}

  const JetStreamSpec spec;
  const OutletContext context_of;

  // Of the thread that uses the outlet.
  PayloadMaker payloads;
  NatsConnection connection;
  JetStreamContext context;
  NatsSubscription commands;
  bool has_streams = false;
  Instant next_attempt{};
  Instant last_ready{};

  std::atomic<bool> is_closing = false;  // by this program: not logged

  std::mutex mutex;  // protects the members below; not held while the library is called
  std::unordered_map<std::string, std::uint64_t> pending;  // records, by message id
  std::vector<OutletResult> results;
  struct Reply {
    std::string subject, text;
  };
  std::vector<Reply> replies;  // to commands

  void accept_commands();
  void send_replies();
  void connect(Instant now);
  void disconnect();
  void finish(const std::string& id, Outcome outcome);

  static void on_result(jsCtx*, natsMsg* message, jsPubAck* done, jsPubAckErr* error,
                        void* closure);
  static void on_command(natsConnection*, natsSubscription*, natsMsg* message, void* closure);
  static void on_connected(natsConnection* from, void* closure);
  static void on_disconnected(natsConnection* from, void* closure);
  static void on_closed(natsConnection* from, void* closure);
};

void JetStreamOutlet::State::on_result(jsCtx*, natsMsg* message, jsPubAck* done, jsPubAckErr* error,
                                       void* closure) {
  const NatsMessage owned(message);
  const char* id = nullptr;
  if (natsMsgHeader_Get(message, "Nats-Msg-Id", &id) != NATS_OK) return;
  const Outcome outcome = outcome_of(done, error);
  const auto bytes = static_cast<std::size_t>(natsMsg_GetDataLength(message));
  if (outcome == Outcome::kFailed) log_failed(natsMsg_GetSubject(message), error);
  if (outcome == Outcome::kRefused)
    log_refused(natsMsg_GetSubject(message), bytes, "max_msg_size of the stream");
  static_cast<State*>(closure)->finish(id, outcome);
}

void JetStreamOutlet::State::finish(const std::string& id, Outcome outcome) {
  {
    const std::lock_guard lock(mutex);
    const auto found = pending.find(id);
    if (found == pending.end()) return;
    results.push_back({found->second, outcome});
    pending.erase(found);
  }
  context_of.wake();
}

void JetStreamOutlet::State::on_connected(natsConnection* from, void* closure) {
  log_info(kSubject, "connected to " + server_of(from));
  static_cast<State*>(closure)->context_of.wake();
}

void JetStreamOutlet::State::on_disconnected(natsConnection* from, void* closure) {
  if (static_cast<State*>(closure)->is_closing) return;
  log_warning(kSubject,
              fmt::format("disconnected ({}); the queue keeps all records", reason_of(from)));
}

void JetStreamOutlet::State::on_closed(natsConnection* from, void* closure) {
  auto& self = *static_cast<State*>(closure);
  if (self.is_closing) return;
  log_counted(LogLevel::kWarning, kSubject, "closed connections",
              fmt::format("connection closed: {}", reason_of(from)));
  self.context_of.wake();
}

void JetStreamOutlet::State::connect(Instant now) {
  next_attempt = now + kPause;
  auto options = nats_options(spec, "fieldcast-forward " + context_of.site);
  if (!options) {
    log_counted(LogLevel::kError, kSubject, "faults of the login", options.error());
    return;
  }
  natsOptions* const raw = options->get();
  natsOptions_SetClosedCB(raw, on_closed, this);
  natsOptions_SetDisconnectedCB(raw, on_disconnected, this);
  natsOptions_SetReconnectedCB(raw, on_connected, this);
  is_closing = false;
  natsConnection* made = nullptr;
  if (const natsStatus status = natsConnection_Connect(&made, raw); status != NATS_OK) {
    const char* const detail = nats_GetLastError(nullptr);
    log_counted(LogLevel::kWarning, kSubject, "failed connections",
                fmt::format("cannot connect: {}; the forwarder tries again",
                            detail == nullptr ? natsStatus_GetText(status) : detail));
    return;
  }
  connection.reset(made);
  last_ready = now;
  log_info(kSubject, "connected to " + server_of(made));
  jsOptions context_options;
  jsOptions_Init(&context_options);
  context_options.PublishAsync.MaxPending =
      context_of.in_flight + 1;  // so that a publish never waits
  context_options.PublishAsync.AckHandler = on_result;
  context_options.PublishAsync.AckHandlerClosure = this;
  jsCtx* js = nullptr;
  if (natsConnection_JetStream(&js, made, &context_options) != NATS_OK) {
    log_error(kSubject, "the library cannot create a context of JetStream");
    connection.reset();
    return;
  }
  context.reset(js);
  if (context_of.on_command) accept_commands();
}

void JetStreamOutlet::State::accept_commands() {
  const std::string subject = command_subject_of(context_of.site);
  natsSubscription* made = nullptr;
  const natsStatus status =
      natsConnection_Subscribe(&made, connection.get(), subject.c_str(), on_command, this);
  commands.reset(made);
  if (status == NATS_OK) return;
  log_error(kSubject, fmt::format("commands cannot be accepted on {}: {}", subject,
                                  natsStatus_GetText(status)));
}

void JetStreamOutlet::State::on_command(natsConnection*, natsSubscription*, natsMsg* message,
                                        void* closure) {
  const NatsMessage owned(message);
  auto* const self = static_cast<State*>(closure);
  const char* const reply = natsMsg_GetReply(message);
  if (reply == nullptr) return;  // nobody would receive the result
  const std::string_view subject = natsMsg_GetSubject(message);
  const std::string_view data(natsMsg_GetData(message),
                              static_cast<std::size_t>(natsMsg_GetDataLength(message)));
  CentreRequest request{.user = name_of_token(subject.substr(subject.rfind('.') + 1)),
                        .text = std::string(data.substr(0, kMaxRequest)),
                        .reply = [self, to = std::string(reply)](std::string text) {
                          {
                            const std::lock_guard lock(self->mutex);
                            self->replies.push_back({to, std::move(text)});
                          }
                          self->context_of.wake();
                        }};
  self->context_of.on_command(std::move(request));
}

void JetStreamOutlet::State::send_replies() {
  std::vector<Reply> waiting;
  {
    const std::lock_guard lock(mutex);
    waiting.swap(replies);
  }
  for (const Reply& reply : waiting) {
    const natsStatus status =
        natsConnection_Publish(connection.get(), reply.subject.c_str(), reply.text.data(),
                               static_cast<int>(reply.text.size()));
    if (status != NATS_OK)
      log_counted(LogLevel::kWarning, kSubject, "responses to commands that could not be sent",
                  natsStatus_GetText(status));
  }
}

void JetStreamOutlet::State::disconnect() {
  is_closing = true;
  if (connection) natsConnection_Close(connection.get());
  commands.reset();
  context.reset();
  connection.reset();
  has_streams = false;
  const std::lock_guard lock(mutex);
  for (const auto& [id, record] : pending) results.push_back({record, Outcome::kFailed});
  pending.clear();
}

JetStreamOutlet::JetStreamOutlet(const JetStreamSpec& spec, OutletContext context)
    : state_(new State(spec, std::move(context))) {}

JetStreamOutlet::~JetStreamOutlet() {
  state_->disconnect();
  nats_CloseAndWait(kCloseMs);
}

bool JetStreamOutlet::is_ready(Instant now) {
  // The library gives a connection up after repeated refusals of the login.
  if (state_->connection && natsConnection_IsClosed(state_->connection.get())) {
    state_->disconnect();
    state_->next_attempt = now + kPause;
  }
  if (!state_->connection && now >= state_->next_attempt) state_->connect(now);
  if (!state_->connection) return false;
  if (natsConnection_Status(state_->connection.get()) != NATS_CONN_STATUS_CONNECTED) {
    if (now - state_->last_ready > kPatience) state_->disconnect();
    return false;
  }
  state_->last_ready = now;
  state_->send_replies();
  if (!state_->spec.streams.create || state_->has_streams) return true;
  if (now < state_->next_attempt) return false;
  if (const auto created = create_streams(*state_->context, state_->spec); !created) {
    log_counted(LogLevel::kError, kSubject, "faults of streams", created.error());
    state_->next_attempt = now + kPause;
    return false;
  }
  state_->has_streams = true;
  return true;
}

std::optional<std::size_t> JetStreamOutlet::send(const Record& record) {
  const std::string id = message_id_of(state_->context_of.site, record);
  const std::string subject = subject_of(state_->context_of.site, state_->spec.bucket, record);
  const auto payload = state_->payloads.payload_of(record);
  {
    const std::lock_guard lock(state_->mutex);
    state_->pending[id] = record.id;
  }
  if (!payload) {
    log_undecodable(record);
    state_->finish(id, Outcome::kRefused);
    return 0;
  }
  natsMsg* made = nullptr;
  natsStatus status = natsMsg_Create(&made, subject.c_str(), nullptr, payload->data(),
                                     static_cast<int>(payload->size()));
  if (status == NATS_OK) {
    jsPubOptions options;
    jsPubOptions_Init(&options);
    options.MsgId = id.c_str();
    options.MaxWait = state_->spec.acknowledgement / std::chrono::milliseconds{1};
    status = js_PublishMsgAsync(state_->context.get(), &made, &options);
    natsMsg_Destroy(made);
  }
  if (status == NATS_OK) return payload->size() + subject.size() + id.size();
  if (status == NATS_MAX_PAYLOAD) {
    log_refused(subject, payload->size(), "max_payload of the server");
    state_->finish(id, Outcome::kRefused);
    return 0;
  }
  log_counted(LogLevel::kWarning, kSubject, "messages that could not be sent",
              fmt::format("{}: {}", subject, natsStatus_GetText(status)));
  const std::lock_guard lock(state_->mutex);
  state_->pending.erase(id);
  return std::nullopt;
}

// Without an acknowledgement: the next report follows in ten seconds.
void JetStreamOutlet::report(const SiteStatus& status) {
  const std::string subject = site_subject_of(state_->spec.site_bucket, status.site);
  const std::string text = to_json(status);
  const natsStatus sent = natsConnection_Publish(state_->connection.get(), subject.c_str(),
                                                 text.data(), static_cast<int>(text.size()));
  if (sent != NATS_OK)
    log_counted(LogLevel::kWarning, kSubject, "reports that could not be sent",
                fmt::format("{}: {}", subject, natsStatus_GetText(sent)));
}

std::vector<OutletResult> JetStreamOutlet::take_results() {
  const std::lock_guard lock(state_->mutex);
  return std::exchange(state_->results, {});
}

}  // namespace fieldcast::forward
