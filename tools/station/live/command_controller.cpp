#include "tools/station/live/command_controller.hpp"

#include <boost/asio/post.hpp>
#include <utility>

#include "bridge/base/clock.hpp"
#include "core/base/message_text.hpp"
#include "core/model/channel_pattern.hpp"

namespace fieldcast::web {
namespace {

constexpr std::size_t kShownInAudit = 128;  // bytes of a value in the audit log

std::string what_of(const StationCommand& command) {
  if (command.command.operation == Operation::kAcquire) return "acquire";
  std::string text = "write";
  for (const Value& value : command.command.values) text += ' ' + fieldcast::to_text(value);
  return printable(text, kShownInAudit);
}

std::string target_of(const StationCommand& command) {
  const auto* channel = std::get_if<ChannelTarget>(&command.command.target);
  const std::string& name =
      channel != nullptr ? channel->name : std::get<AddressTarget>(command.command.target).at;
  std::string text = command.bus + '/' + command.command.device;
  if (!name.empty()) text += '/' + name;
  return text;
}

std::string target_of(const AlarmAction& action) {
  if (is_of_device(action.kind)) return action.alarm.bus + '/' + action.alarm.device;
  return to_text(action.alarm);
}

}  // namespace

CommandController::CommandController(boost::asio::io_context& io, CommandPort& port, Audit* audit,
                                     Done others)
    : io_(io),
      port_(port),
      audit_(audit),
      others_(std::move(others)),
      timer_(io),
      worker_("commands", kMaxQueued, [this](auto& queue) { run(queue); }) {}

CommandController::~CommandController() { close(); }

void CommandController::close() {
  open_.reset();
  timer_.cancel();
  worker_.close();
}

void CommandController::post(std::function<void()> task) {
  boost::asio::post(io_, [alive = alive_, task = std::move(task)] {
    if (!alive.expired()) task();
  });
}

void CommandController::run(BoundedQueue<std::function<void()>>& queue) {
  while (const auto task = queue.take()) {
    if (queue.closed()) return;
    (*task)();
    declare_all();
  }
}

CommandController::Submitted CommandController::submit(const Caller& caller, StationCommand command,
                                                       Done done) {
  command.person = caller.user;
  PendingCommands::Asked asked{0, caller, what_of(command), target_of(command)};
  const Duration lifespan = command.lifespan;
  const auto id = command.command.request_id = port_.reserve_request_id();
  asked.request_id = id;
  CommandRoute& route = route_to(command.bus);
  return enter(
      std::move(asked),
      [&route, command = std::move(command)]() mutable { return route.send(std::move(command)); },
      lifespan, std::move(done));
}

CommandController::Submitted CommandController::submit(const Caller& caller, AlarmAction action,
                                                       Done done) {
  action.by = caller.user;
  PendingCommands::Asked asked{0, caller, std::string(to_text(action.kind)), target_of(action)};
  if (!action.note.empty()) asked.what += ": " + printable(action.note, kShownInAudit);
  asked.request_id = action.request_id = port_.reserve_request_id();
  CommandRoute& route = route_to(action.alarm.bus);
  return enter(
      std::move(asked),
      [&route, action = std::move(action)]() mutable { return route.send(std::move(action)); },
      StationCommand{}.lifespan, std::move(done));
}

CommandController::Submitted CommandController::enter(PendingCommands::Asked asked, Send send,
                                                      Duration lifespan, Done done) {
  if (auto refusal = book_.why_not(asked.caller.user)) return tl::unexpected(std::move(*refusal));
  const std::uint64_t id = asked.request_id;
  const Instant now = steady_now();
  const Instant latest = now + kPatience;
  std::function<void()> task = [this, id, latest, lifespan, send = std::move(send)]() mutable {
    if (steady_now() > latest) return;  // the command has expired in book_
    const Sent sent = send();
    const Instant deadline = steady_now() + lifespan + kResult;
    post([this, id, sent, deadline] {
      if (sent) return book_.on_sent(id, deadline);
      finish(book_.on_fault(id, sent.error()));
    });
  };
  if (!worker_.queue().try_put(task))
    return tl::unexpected(Refusal{"too many commands wait", "try again later"});
  book_.add(std::move(asked), std::move(done), latest + kFinding);
  watch();
  return id;
}

void CommandController::set_stream(CommandRoute& route, IsOfStream is_of_stream) {
  stream_ = &route;
  is_of_stream_ = std::move(is_of_stream);
}

CommandRoute& CommandController::route_to(const std::string& bus) {
  return stream_ != nullptr && is_of_stream_(bus) ? *stream_ : port_;
}

void CommandController::on_outcome(std::uint64_t request_id, const StationOutcome& outcome) {
  if (outcome) return on_result(*outcome);
  post([this, request_id, fault = outcome.error()] { finish(book_.on_fault(request_id, fault)); });
}

void CommandController::on_result(const StationResult& result) {
  post([this, result] { finish(book_.on_result(result)); });
}

void CommandController::finish(std::optional<PendingCommands::Ended> ended) {
  if (!ended) return;
  const CommandOutcome& outcome = ended->outcome;
  if (audit_ != nullptr) {
    const Caller& caller = ended->asked.caller;
    std::string result = outcome.state;
    if (!outcome.reason.empty()) result += ": " + printable(outcome.reason);
    audit_->append({.who = printable(caller.user) +
                           (caller.peer.empty() ? "" : " from " + printable(caller.peer)),
                    .what = ended->asked.what,
                    .target = ended->asked.target,
                    .result = result});
  }
  ended->done ? ended->done(outcome) : others_(outcome);
}

void CommandController::watch() {
  if (watching_ || book_.under_way() == 0) return;
  watching_ = true;
  timer_.expires_after(std::chrono::milliseconds{500});
  timer_.async_wait([this, alive = alive_](boost::system::error_code cancelled) {
    if (cancelled || alive.expired()) return;
    watching_ = false;
    const Instant now = steady_now();
    while (auto expired = book_.take_expired(now)) finish(std::move(expired));
    watch();
  });
}

void CommandController::declare(const std::string& pattern, Duration refresh) {
  {
    const std::lock_guard lock(mutex_);
    declares_[pattern] = refresh;
  }
  // If the queue is full, the tasks in it declare the waiting interests.
  std::function<void()> task = [] {};
  (void)worker_.queue().try_put(task);
}

void CommandController::declare_all() {
  std::map<std::string, Duration> waiting;
  {
    const std::lock_guard lock(mutex_);
    std::swap(waiting, declares_);
  }
  for (const auto& [pattern, refresh] : waiting) port_.declare(pattern, refresh);
}

}  // namespace fieldcast::web
