// Events and decisions: what goes on the wire next, and what an exchange's end means for its
// device.
#include "core/bus/bus_engine.hpp"

#include <algorithm>

#include "core/bus/bus_state.hpp"
#include "core/schedule/bus_schedule.hpp"

namespace fieldcast {
namespace {

Echo echo_for(const BusSpec& bus) {
  if (over_network(bus.port) && !bus.echo) return Echo::kAbsent;
  if (!bus.echo) return Echo::kUnknown;
  return *bus.echo ? Echo::kPresent : Echo::kAbsent;
}

}  // namespace

BusEngine::State::State(const BusSpec& bus, TextCodec& text_codec)
    : setup(bus),
      spec(setup.spec()),
      line(setup.line()),
      silence(setup.silence()),
      codec(text_codec),
      channels(spec, codec),
      commands(setup, channels, codec),
      driver(line, spec.gap_allowance, echo_for(spec)),
      late(setup) {
  for (DeviceIndex index = 0; index < setup.devices(); ++index) {
    devices.emplace_back();
    devices.back().areas.resize(setup.protocol(index).areas().size());
  }
  make_scheduler();
  monitor.emplace(setup, probed());
}

BusEngine::BusEngine(const BusSpec& spec, TextCodec& codec)
    : state_(std::make_unique<State>(spec, codec)) {}
BusEngine::~BusEngine() = default;

std::uint32_t BusEngine::missing() const { return state_->driver.missing(); }

bool BusEngine::exchanging() const { return state_->driver.active(); }

void BusEngine::set_trace(bool on) { state_->trace = on; }

void BusEngine::on_event(const BusEvent& event, Instant now, Actions& actions) {
  State& s = *state_;
  if (!s.begun) {
    s.begun = true;
    s.channels.start(now);
    std::vector<Sample> first;
    s.channels.not_yet_read(first);
    if (!first.empty()) actions.push_back(Publish{std::move(first)});
  }
  struct Handle {
    State& s;
    Instant now;
    Actions& actions;
    void operator()(const Opened&) const { s.opened(now); }
    void operator()(const Closed& e) const { s.closed(e, now, actions); }
    void operator()(const Received& e) const {
      if (!s.driver.active() || s.bus_state != BusState::kRunning)
        return s.heard_stray(e.bytes, now, actions);
      Bytes out;
      const auto outcome = s.driver.on_bytes(e.bytes, now, out);
      if (outcome != ExchangeDriver::Outcome::kSend)
        s.take_late(s.late_in_exchange(now), now, actions);
      if (outcome == ExchangeDriver::Outcome::kDone && s.is_another_answer()) {
        const State::Flight& flight = *s.flight;
        s.driver.wait_on(s.setup.protocol(flight.device).begin(flight.request, flight.context));
        s.late.start_anew();
        return;
      }
      s.advance(outcome, std::move(out), now, actions);
    }
    void operator()(const TimerFired&) const { s.timer = kNever; }
    void operator()(const CommandArrived& e) const {
      const auto device = s.setup.find(e.command.device);
      const bool offline = device && s.monitor->offline(*device);
      ActionSink sink(s.setup, s.samples, actions);
      s.commands.accept(e.command, {s.bus_state, offline}, now, sink);
    }
    void operator()(const InterestChanged& e) const {
      s.set_interest(e.channel, e.refresh, now, actions);
    }
    void operator()(const LeaseBegan&) const { s.begin_lease(now, actions); }
    void operator()(const LeaseEnded&) const {
      if (s.bus_state != BusState::kLeased) return;
      s.opened(now);
      s.channels.start(now);
    }
    void operator()(const PlanMade& e) const { s.scheduler->adopt(*e.draft, now); }
    void operator()(const StopRequested&) const {
      s.driver.abort();
      s.flight.reset();
      s.bus_state = BusState::kStopped;
      ActionSink sink(s.setup, s.samples, actions);
      s.commands.refuse_all(Cause::kShutdown, std::string(to_text(Cause::kShutdown)), now, sink);
    }
  };
  std::visit(Handle{s, now, actions}, event);
  s.settle(now, actions);
}

// After every event: what ran out by now, what goes on the wire next, and when to look again.
void BusEngine::State::settle(Instant now, Actions& actions) {
  if (driver.active() && now >= driver.deadline()) {
    Bytes out;
    const auto outcome = driver.on_timer(now, out);
    advance(outcome, std::move(out), now, actions);
  }
  if (bus_state != BusState::kStopped && bus_state != BusState::kLeased)
    expire_channels(now, actions);
  ActionSink sink(setup, samples, actions);
  commands.expire(now, sink);
  if (bus_state == BusState::kRunning && !driver.active()) decide(now, actions);
  if (auto told = overload->look(scheduler->stretch(), now)) actions.push_back(std::move(*told));
  ask_for_plan(actions);

  Instant next = kNever;
  if (bus_state != BusState::kStopped) {
    next = commands.next_expiry();
    if (bus_state != BusState::kLeased) next = std::min(next, channels.next_expiry());
    if (driver.active())
      next = std::min(next, driver.deadline());
    else if (bus_state == BusState::kRunning)
      next = std::min(next, std::max(free_at, rest_until));
  }
  if (next == timer) return;
  timer = next;
  actions.push_back(SetTimer{next});
}

void BusEngine::State::ask_for_plan(Actions& actions) {
  struct Kept {
    std::vector<std::shared_ptr<const Protocol>> protocols;  // the draft asks them for sizes
    std::unique_ptr<PlanDraft> draft;
  };
  auto draft = scheduler->draft();
  if (!draft) return;
  auto kept = std::make_shared<Kept>(Kept{setup.protocols(), std::move(draft)});
  actions.push_back(MakePlan{{kept, kept->draft.get()}});
}

void BusEngine::State::decide(Instant now, Actions& actions) {
  rest_until = kLongAgo;
  if (now < free_at) return;
  if (flight && flight->waiting) return transmit(now, actions);

  if (!commands.empty()) {
    // A command goes before reads, but after it a read that is due goes before the next command:
    // neither starves the other.
    const bool reads_turn = command_was_last && !commands.begun() &&
                            std::holds_alternative<Block>(scheduler->next(now));
    if (!reads_turn) {
      if (auto next = commands.next(now, gate(), driver.echo() == Echo::kUnknown)) {
        Flight command;
        command.kind = Flight::Kind::kCommand;
        command.device = next->device;
        command.request = std::move(next->request);
        command.batch = next->batch;
        return launch(std::move(command), now, actions);
      }
      if (commands.begun()) {  // its device must rest: the wire waits for nobody else in the middle
                               // of a command, unless that takes long
        const Instant from = commands.sendable_from(gate());
        if (from - now <= kShortWait) {
          rest_until = from;
          return;
        }
      }
    }
  }
  if (auto probe = probe_due(now)) return launch(std::move(*probe), now, actions);
  std::vector<DeviceIndex> admitted;
  const Instant next_admission = monitor->admit_deferred(
      now, [&] { return scheduler->slack(now); }, admitted);
  for (const DeviceIndex device : admitted) rest_device(device, now);

  Decision decision = scheduler->next(now);
  for (int tried = 0; std::holds_alternative<Block>(decision); ++tried) {
    auto& block = std::get<Block>(decision);
    Flight read;
    read.device = block.device;
    read.request = ReadRequest{block.ranges};
    read.block = std::move(block);
    const Instant from = askable_from(read);
    if (from <= now || make_distinct(read, now)) return launch(std::move(read), now, actions);
    hold(read.block, from, now);
    decision = tried < kMostHeld ? scheduler->next(now) : Rest{from};
  }
  rest_until = std::min({std::get<Rest>(decision).until, monitor->next_probe(), next_admission});
  // Commands whose devices are pausing; behind one that has begun the others wait.
  rest_until = std::min(rest_until, commands.sendable_from(gate()));
  rest_until = std::max(
      rest_until,
      now + std::chrono::microseconds{100});  // a scheduler that rests until now must not spin
}

void BusEngine::State::launch(Flight next, Instant now, Actions& actions) {
  flight = std::move(next);
  command_was_last = flight->kind == Flight::Kind::kCommand;
  transmit(now, actions);
}

void BusEngine::State::transmit(Instant now, Actions& actions) {
  if (flight->tries == 0) flight->started = now;
  flight->waiting = false;
  flight->rest = monitor->rest_before(flight->device, now);
  const bool command = flight->kind == Flight::Kind::kCommand;
  const Duration timeout = flight->timeout > Duration::zero()
                               ? flight->timeout
                               : monitor->timeout(flight->device, flight->request, command);
  flight->context = late.next_context(flight->device);
  strays_since = kNever;
  late.start_anew();
  Bytes out;
  driver.begin(
      setup.protocol(flight->device).begin(flight->request, flight->context), timeout,
      driver.echo() != Echo::kUnknown || setup.answer_differs(flight->device, flight->request), now,
      out);
  ++exchanges;
  monitor->asked(flight->device);
  actions.push_back(Send{std::move(out)});
}

// When the next request of a command may go out: after its device's rest, and when no answer that
// is owed could be taken for its own; not even one to the same read, which was asked before.
Instant BusEngine::State::command_from(const CommandJob& job) const {
  Flight next;
  next.kind = Flight::Kind::kCommand;
  next.device = job.device();
  Instant from = monitor->paused_until(next.device);
  if (late.none_owed()) return from;
  if (auto request = job.next()) {
    next.request = std::move(*request);
    from = std::max(from, askable_from(next));
  }
  return from;
}

void BusEngine::State::advance(ExchangeDriver::Outcome outcome, Bytes&& out, Instant now,
                               Actions& actions) {
  switch (outcome) {
    case ExchangeDriver::Outcome::kWaiting: return;
    case ExchangeDriver::Outcome::kSend:
      late.start_anew();
      actions.push_back(Send{std::move(out)});
      return;
    case ExchangeDriver::Outcome::kDone: return conclude(true, now, actions);
    case ExchangeDriver::Outcome::kFailed: return conclude(false, now, actions);
  }
}

bool BusEngine::State::try_again(const Flight& tried, Cause cause) const {
  if (cause == Cause::kDeviceError || cause == Cause::kDeviceBusy || cause == Cause::kUnsupported)
    return false;
  // Writes are never repeated blindly (CommandJob reads back instead); probes are rare by
  // themselves. A sick device's reads wait until the wire has time for them (defer()).
  return tried.kind != Flight::Kind::kProbe && std::holds_alternative<ReadRequest>(tried.request) &&
         tried.tries < setup.device(tried.device).retries &&
         !(tried.kind == Flight::Kind::kRead && monitor->sick(tried.device));
}

// The exchange in flight is over.
void BusEngine::State::conclude(bool done, Instant now, Actions& actions) {
  const Traits& traits = setup.protocol(flight->device).traits();
  const Cause cause = done ? Cause::kNone : driver.cause();
  const std::uint16_t code = driver.device_code();
  const auto exchange = driver.finish();
  free_at = now + silence;
  const Duration spent = free_at - flight->started;
  if (cause == Cause::kNoAnswer || cause == Cause::kTruncated) flight->timed_out = true;
  const bool answered = done || cause == Cause::kDeviceError || cause == Cause::kDeviceBusy;
  ActionSink sink(setup, samples, actions);
  settle_debts_of(*flight, answered, !done, now);
  monitor->tried(
      {flight->device, cause, flight->rest, driver.answered(), driver.heard(), driver.sent()}, now,
      sink);
  if (!done) {
    causes.add(cause);
    if (trace)
      sink.push(Traced{setup.device(flight->device).name,
                       std::string(to_text(cause)) + device_code_note(traits.codes, code)});
    if (try_again(*flight, cause)) {
      ++flight->tries;
      monitor->repeated(flight->device);
      flight->waiting = true;
      return;
    }
  }
  Flight ended = std::move(*flight);
  flight.reset();
  load.ended(spent, ended.kind == Flight::Kind::kRead);

  if (done && !ended.timed_out) {
    monitor->learn(ended.device, ended.request, driver.answer_time());
    if (std::holds_alternative<ReadRequest>(ended.request))
      planned_times.answered(ended.device, area_of(ended.request), driver.answer_time(),
                             *scheduler);
  }
  if (answered) monitor->answered(ended.device, sink);
  switch (ended.kind) {
    case Flight::Kind::kRead:
      if (done)
        block_read(ended, exchange->reply(), driver.answered(), now, actions);
      else
        block_failed(ended, cause, code, now, actions);
      break;
    case Flight::Kind::kCommand:
      if (done)
        commands.answered(ended.batch, exchange->reply(), driver.answered(), now, sink);
      else
        commands.failed(ended.batch, cause, code, driver.answered(), now, sink);
      break;
    case Flight::Kind::kProbe: break;
  }
  if (!answered) device_failed(ended, cause, spent, now, sink);
  rest_device(ended.device, now);
  // A stream whose framing is lost cannot be mended in place (Modbus Messaging on TCP/IP, 4.2.2
  // leaves the reaction open: close). A serial line falls silent instead, also behind a serial
  // server: there a bad frame costs its exchange alone.
  if (cause == Cause::kMalformed && traits.identity == AnswerIdentity::kSequence &&
      setup.plain_tcp()) {
    actions.push_back(Reopen{"the answer's header makes no sense"});
    bus_state = BusState::kOpening;
  }
}

Instant BusEngine::State::askable_from(const Flight& next) const {
  return late.sendable_from(next.device, next.request,
                            next.kind == Flight::Kind::kCommand ? LateAnswers::Purpose::kCommand
                                                                : LateAnswers::Purpose::kRead);
}

// A flight has ended, or will be tried again: what its device owes now.
void BusEngine::State::settle_debts_of(const Flight& ended, bool answered, bool refused,
                                       Instant now) {
  Asked asked{ended.device, ended.request, ended.context, driver.sent_until()};
  const Duration longest = monitor->longest_answer(ended.device);
  if (!answered) return late.unanswered(std::move(asked), ended.block, longest, driver, now);
  late.answered(asked, refused, longest, driver, now);
  release_held(now);
}

// An exchange is broken off from outside.
void BusEngine::State::owe_flight_under_way() {
  if (!driver.active() || !flight) return;
  late.broken_off({flight->device, flight->request, flight->context, driver.sent_until()},
                  monitor->longest_answer(flight->device));
}

std::vector<LateAnswers::Late> BusEngine::State::late_in_exchange(Instant now) {
  if (late.none_owed()) return {};
  return late.in_exchange({flight->device, flight->request, flight->context, {}}, driver, now);
}

void BusEngine::State::take_late(std::vector<LateAnswers::Late> answers, Instant now,
                                 Actions& actions) {
  for (LateAnswers::Late& answer : answers) {
    monitor->learn_late(answer.asked.device, answer.taken);
    if (answer.block.points.empty()) continue;
    Flight read;
    read.device = answer.asked.device;
    read.request = answer.asked.request;
    read.block = std::move(answer.block);
    ActionSink sink(setup, samples, actions);
    monitor->answered(read.device, sink);
    block_read(read, answer.reply, now, now, actions);
    // Nor need it be asked again.
    if (flight && flight->waiting && flight->kind == Flight::Kind::kRead &&
        same_read(answer.asked, {flight->device, flight->request, {}, {}}))
      flight.reset();
  }
  release_held(now);
}

// Nobody was asked: a late answer, one too many, or what others say. The line must fall silent
// before it is used.
void BusEngine::State::heard_stray(ByteView bytes, Instant now, Actions& actions) {
  driver.count_stray(bytes.size());
  if (bus_state != BusState::kRunning) return;
  if (strays_since == kNever) strays_since = now;
  if (now - strays_since < kLongestStray) free_at = std::max(free_at, now + silence);
  if (late.none_owed()) return;
  take_late(late.in_strays(bytes, now), now, actions);
}

// The exchange is done, but too soon: an answer that began before its request had ended.
bool BusEngine::State::is_another_answer() const {
  if (late.owes_same({flight->device, flight->request, flight->context, {}})) return false;
  return monitor->too_early(flight->device, driver.answer_began());
}

void BusEngine::State::opened(Instant now) {
  if (bus_state == BusState::kStopped) return;
  bus_state = BusState::kRunning;
  owe_flight_under_way();
  driver.abort();
  flight.reset();
  late.start_anew();
  free_at = now + silence;
  monitor->opened(now);
}

void BusEngine::State::closed(const Closed& why, Instant now, Actions& actions) {
  if (bus_state == BusState::kStopped) return;
  if (bus_state == BusState::kRunning) ++reopened;
  bus_state = BusState::kClosed;
  closed_because = why.cause;
  if (why.cause != Cause::kPortClosed) causes.add(why.cause);
  owe_flight_under_way();
  // What a connection brought late ends with it, unless there is a serial line behind it.
  if (setup.plain_tcp()) late.forget_all();
  driver.abort();
  ActionSink sink(setup, samples, actions);
  if (flight) {
    if (flight->kind == Flight::Kind::kCommand)
      commands.failed(flight->batch, Cause::kPortClosed, 0, driver.answered(), now, sink);
    if (flight->kind == Flight::Kind::kRead) scheduler->failed(flight->block, now, now);
    causes.add(Cause::kPortClosed);
  }
  flight.reset();
  for (ChannelIndex c = 0; c < channels.size(); ++c) channels.failing(c, Cause::kPortClosed, now);
  commands.refuse_all(Cause::kOffline, "port is down: " + why.reason, now, sink);
}

void BusEngine::State::begin_lease(Instant now, Actions& actions) {
  if (bus_state == BusState::kStopped) return;
  owe_flight_under_way();
  driver.abort();
  ActionSink sink(setup, samples, actions);
  if (flight && flight->kind == Flight::Kind::kCommand)
    commands.failed(flight->batch, Cause::kLeased, 0, driver.answered(), now, sink);
  flight.reset();
  bus_state = BusState::kLeased;
  commands.refuse_all(Cause::kLeased, std::string(to_text(Cause::kLeased)), now, sink);
  std::vector<Sample> out;
  channels.all_uncertain(now, out);
  if (!out.empty()) actions.push_back(Publish{std::move(out)});
}

void BusEngine::State::expire_channels(Instant now, Actions& actions) {
  if (channels.next_expiry() > now) return;
  std::vector<Sample> out;
  channels.expire(now, out);
  samples += out.size();
  if (!out.empty()) actions.push_back(Publish{std::move(out)});
}

// Of an exchange that was not answered.
void BusEngine::State::device_failed(const Flight& ended, Cause cause, Duration spent, Instant now,
                                     ActionSink& sink) {
  const DeviceIndex index = ended.device;
  if (monitor->failed(index, cause, now, sink)) {
    DeviceRuntime& device = devices[index];
    device.refused_longer = false;
    planned_times.forget(index);
    for (AreaIndex area = 0; area < device.areas.size(); ++area) {
      if (device.areas[area].forget()) scheduler->set_longest(index, area, 0);
    }
    for (ChannelIndex c = channels.first_of(index); c < channels.end_of(index); ++c)
      channels.failing(c, cause, now);
    if (monitor->all_offline() && over_network(spec.port)) {
      // Every device behind this connection is silent: perhaps only the connection is dead.
      sink.push(Reopen{"no device answers"});
      bus_state = BusState::kOpening;
    }
  }
  monitor->defer_if_sick(index, spent, now);
}

// Tells the scheduler how long the device is left alone.
void BusEngine::State::rest_device(DeviceIndex index, Instant now) {
  if (const auto until = monitor->suspension(index, now)) scheduler->suspend(index, *until);
}

std::optional<BusEngine::State::Flight> BusEngine::State::probe_due(Instant now) {
  auto due = monitor->probe(
      now,
      [&](DeviceIndex device, const Request& request) {
        return late.sendable_from(device, request, LateAnswers::Purpose::kRead);
      },
      [&] { return scheduler->slack(now); });
  if (!due) return std::nullopt;
  Flight probe;
  probe.kind = Flight::Kind::kProbe;
  probe.device = due->device;
  probe.request = std::move(due->request);
  probe.timeout = due->timeout;
  return probe;
}

// The first point of each device.
std::vector<std::optional<Range>> BusEngine::State::probed() const {
  std::vector<std::optional<Range>> ranges(setup.devices());
  for (const Point& point : map.points) {
    if (auto& range = ranges[point.device]; !range) range = point.range;
  }
  return ranges;
}

void make_plans(BusEngine& engine, Instant now, Actions& actions) {
  for (std::size_t i = 0; i < actions.size(); ++i) {
    const auto* wanted = std::get_if<MakePlan>(&actions[i]);
    if (!wanted) continue;
    const auto draft = wanted->draft;
    draft->make();
    engine.on_event(PlanMade{draft}, now, actions);
  }
}

}  // namespace fieldcast
