#include "core/bus/bus_engine.hpp"

#include <algorithm>
#include <iterator>

#include "core/bus/bus_parts.hpp"

namespace fieldcast {
namespace {

std::string text_of(Cause cause) { return std::string(to_text(cause)); }

}  // namespace

BusEngine::BusEngine(const BusSpec& spec, TextCodec& codec)
    : parts_(spec, codec),
      arbiter_(parts_),
      outcomes_(parts_, arbiter_),
      overload_(parts_.reads.stretch()) {}

void BusEngine::inherit(const BusInheritance& inherited, Instant now) {
  parts_.channels.count_above(inherited.above);
  for (const Sample& sample : inherited.samples) {
    parts_.channels.inherit(sample);
    if (sample.channel < parts_.channels.size()) parts_.calculator.take({&sample, 1});
    parts_.reads.inherit(sample.channel, sample.acquired);
  }
  for (const auto& [name, learned] : inherited.devices) {
    const auto device = parts_.setup.find(name);
    if (!device) continue;
    parts_.devices.inherit(*device, learned);
    parts_.reads.inherit(*device, learned, now);
  }
}

void BusEngine::on_event(const BusEvent& event, Instant now, Actions& actions) {
  ActionSink sink(parts_.setup, samples_, actions, tracing_);
  const std::size_t begin = actions.size();
  if (!begun_) {
    begun_ = true;
    parts_.channels.start(now);
    std::vector<Sample> first;
    parts_.channels.not_yet_read(first);
    sink.publish_uncounted(std::move(first));
  }
  std::visit([&](const auto& e) { handle(e, now, sink); }, event);
  settle(now, sink);
  if (!parts_.calculator.empty()) calculate(begin, now, actions);
  set_timer(sink);
}

void BusEngine::calculate(std::size_t begin, Instant now, Actions& actions) {
  Publish* block = nullptr;
  for (std::size_t i = begin; i < actions.size(); ++i) {
    auto* const publish = std::get_if<Publish>(&actions[i]);
    if (publish == nullptr) continue;
    parts_.calculator.take(publish->samples);
    block = publish;
  }
  std::vector<Sample> results;
  parts_.calculator.update([&](ChannelIndex channel, const Calculated& result) {
    parts_.channels.calculated(channel, result, now, results);
  });
  samples_ += results.size();
  if (results.empty()) return;
  if (block == nullptr) return actions.push_back(Publish{std::move(results)});
  std::ranges::move(results, std::back_inserter(block->samples));
}

void BusEngine::handle(const Opened& event, Instant now, ActionSink&) {
  if (state_ == BusState::kStopped) return;
  state_ = BusState::kRunning;
  break_all_off();
  parts_.late.start_anew();
  parts_.session.clear();
  stream_.clear();
  parts_.in_flight.opened();
  parts_.listener.opened();
  for (Wire& wire : parts_.wires) wire.opened(std::max(now, event.quiet_until));
  parts_.fence.opened(now);
  parts_.devices.opened(now);
}

void BusEngine::handle(const Closed& event, Instant now, ActionSink& sink) {
  if (state_ == BusState::kStopped) return;
  if (state_ == BusState::kRunning) ++reopened_;
  state_ = BusState::kClosed;
  closed_because_ = event.cause;
  if (event.cause != Cause::kPortClosed) outcomes_.count(event.cause);
  std::optional<Cause> cause;
  if (over_network(spec().port)) cause = Cause::kPortClosed;
  give_all_up(cause, now, sink);
  // Without a serial line behind it, a closed connection delivers no more late responses.
  if (parts_.setup.plain_tcp()) parts_.late.forget_all();
  for (ChannelIndex c = 0; c < parts_.channels.size(); ++c)
    parts_.channels.failing(c, Cause::kPortClosed, now);
  parts_.commands.refuse_all(Cause::kOffline, "port is down: " + event.reason, now, sink);
}

void BusEngine::handle(const Received& event, Instant now, ActionSink& sink) {
  if (state_ == BusState::kRunning && parts_.listener.active())
    outcomes_.take_unsolicited(parts_.listener.on_bytes(event.bytes, now), now, sink);
  if (parts_.wires.size() > 1 || parts_.setup.datagrams()) {
    if (state_ == BusState::kRunning) take_frames(event.bytes, now, sink);
    return;
  }
  if (!parts_.wire().exchanging()) {
    parts_.wire().count_stray(event.bytes.size());
    if (state_ != BusState::kRunning) return;
    return take_stray(event.bytes, now, sink);
  }
  Bytes out;
  auto outcome = parts_.late.skip_repetition(parts_.wire(), event.bytes, now, out);
  const Asked& asked = parts_.wire().flight().asked;
  parts_.fence.bytes_came(parts_.wire().driver().received().empty(), now);
  // The wire may belong to another master, and these bytes to its exchange.
  if (parts_.fence.listening()) {
    give_up(Cause::kForeignMaster, now, sink);
    return take_stray(event.bytes, now, sink);
  }
  if (another_asked(outcome, now, sink)) return;
  if (outcome != ExchangeDriver::Outcome::kSend) {
    const auto late = parts_.late.in_exchange(asked, parts_.wire().driver(), now);
    if (!late.empty()) forecast_.doubt();
    outcomes_.take_late(late, now, sink);
    // The refusal was that of an earlier request. If not, a repetition of this one is refused, too.
    if (outcome == ExchangeDriver::Outcome::kFailed && !late.empty() && late.back().refused)
      outcome = parts_.late.skip_late(parts_.wire(), now, out);
  }
  const ByteView received = parts_.wire().driver().received();
  // A response that began before the end of its request belongs to another request.
  if (outcome == ExchangeDriver::Outcome::kDone && !parts_.late.owes_same(asked) &&
      (is_too_early(asked.device) ||
       (forecast_.too_early(parts_.wire().driver()) &&
        parts_.late.end_of_response(asked, received) < received.size()))) {
    forecast_.doubt();
    parts_.wire().wait_on();
    return parts_.late.start_anew();
  }
  if (out.empty() && parts_.wire().driver().got_response(outcome)) {
    const auto until = repetition_until(now);
    if (until > now) return parts_.wire().hold(outcome, until);
  }
  advance(outcome, std::move(out), now, sink);
}

void BusEngine::take_frames(ByteView bytes, Instant now, ActionSink& sink) {
  if (parts_.setup.datagrams()) return take_frame(bytes, now, sink);
  append(stream_, bytes);
  while (!stream_.empty() && state_ == BusState::kRunning) {
    const auto size = parts_.setup.first_frame(stream_);
    if (!size)
      return reopen({"the header of a response is not valid"}, Cause::kMalformed, now, sink);
    if (*size == 0) return;
    const Bytes frame(stream_.begin(), stream_.begin() + static_cast<std::ptrdiff_t>(*size));
    stream_.erase(stream_.begin(), stream_.begin() + static_cast<std::ptrdiff_t>(*size));
    take_frame(frame, now, sink);
  }
}

void BusEngine::take_frame(ByteView frame, Instant now, ActionSink& sink) {
  Bytes out;
  for (Wire& wire : parts_.wires) {
    if (!wire.exchanging()) continue;
    const auto outcome = wire.on_frame(frame, now, out);
    if (outcome == ExchangeDriver::Outcome::kWaiting) continue;
    parts_.select(wire);
    return advance(outcome, std::move(out), now, sink);
  }
  parts_.wire().count_stray(frame.size());
  outcomes_.take_late(parts_.late.in_strays(frame, now), now, sink);
}

// While the fence listens, unsolicited bytes are not late responses: another master may have sent
// the same request.
void BusEngine::take_stray(ByteView bytes, Instant now, ActionSink& sink) {
  parts_.wire().stray(now);
  if (parts_.late.none_owed()) parts_.late.repetitions().stray(bytes, now);
  parts_.fence.bytes_came(false, now);
  forecast_.doubt();
  std::vector<LateResponseFilter::Late> late;
  if (!parts_.late.none_owed() && !parts_.fence.listening())
    late = parts_.late.in_strays(bytes, now);
  if (late.empty() && parts_.fence.stray(bytes, now)) let_go(now, sink);
  outcomes_.take_late(late, now, sink);
}

void BusEngine::handle(const TimerFired&, Instant, ActionSink&) { timer_ = kNever; }

void BusEngine::handle(const CommandArrived& event, Instant now, ActionSink& sink) {
  if (event.command.ad_hoc) {
    if (auto admitted = parts_.admit(event.command, now); !admitted)
      return sink.push(Complete{rejection(event.command, admitted.error().cause,
                                          std::move(admitted.error().reason), now)});
  }
  const auto device = parts_.setup.find(event.command.device);
  parts_.commands.accept(event.command, {state_, device && parts_.devices.offline(*device)}, now,
                         sink);
}

void BusEngine::handle(const InterestChanged& event, Instant now, ActionSink& sink) {
  parts_.reads.set_interest(event.channel, event.refresh, now, sink);
}

void BusEngine::handle(const LeaseBegan&, Instant now, ActionSink& sink) {
  if (state_ == BusState::kStopped) return;
  for (Wire& wire : parts_.wires) {
    parts_.select(wire);
    const auto broken = break_off();
    if (broken && broken->is_command())
      parts_.commands.failed(broken->batch, Cause::kLeased, 0, wire.driver().responded(), now,
                             sink);
  }
  state_ = BusState::kLeased;
  parts_.commands.refuse_all(Cause::kLeased, text_of(Cause::kLeased), now, sink);
  std::vector<Sample> last;
  parts_.channels.all_uncertain(now, last);
  sink.publish_uncounted(std::move(last));
}

// The response to the last request of the engineer may still arrive.
void BusEngine::handle(const LeaseEnded&, Instant now, ActionSink& sink) {
  if (state_ != BusState::kLeased) return;
  const Instant until = now + longest_timeout();
  handle(Opened{until}, now, sink);
  parts_.channels.start(until);
}

Duration BusEngine::longest_timeout() const {
  Duration longest{};
  for (const DeviceSpec& device : spec().devices) longest = std::max(longest, device.timeout);
  return longest;
}

void BusEngine::handle(const StopRequested&, Instant now, ActionSink& sink) {
  break_all_off();
  state_ = BusState::kStopped;
  parts_.commands.refuse_all(Cause::kShutdown, text_of(Cause::kShutdown), now, sink);
}

void BusEngine::handle(const CountAbove& event, Instant, ActionSink& sink) {
  if (state_ == BusState::kStopped) return;
  parts_.channels.count_above(event.number);
  std::vector<Sample> shown;
  parts_.channels.again(shown);
  sink.publish_uncounted(std::move(shown));
}

void BusEngine::handle(const NotSent& event, Instant now, ActionSink& sink) {
  const auto sender = parts_.sender_of(event.bytes);
  if (!sender) return;
  parts_.select(parts_.wires[*sender]);
  parts_.fence.not_sent(now);
  // Earlier requests of the exchange may have had an effect.
  if (!parts_.wire().first_request()) return give_up(Cause::kForeignMaster, now, sink);
  const Flight kept = parts_.wire().not_sent(now);
  parts_.devices.not_asked(kept.asked.device);
  if (kept.is_command()) parts_.commands.not_sent(kept.batch);
  if (kept.kind == Flight::Kind::kRead) parts_.reads.broken_off(kept.block, now);
}

void BusEngine::handle(const PlanMade& event, Instant now, ActionSink&) {
  parts_.reads.adopt(*event.draft, now);
}

void BusEngine::handle(const InputsArrived& event, Instant, ActionSink&) {
  parts_.calculator.take(event.samples);
}

void BusEngine::settle(Instant now, ActionSink& sink) {
  for (Wire& wire : parts_.wires) {
    if (!wire.exchanging() || now < wire.driver().deadline()) continue;
    parts_.select(wire);
    Bytes out;
    const auto outcome = wire.on_timer(now, out);
    if (!another_asked(outcome, now, sink)) advance(outcome, std::move(out), now, sink);
  }
  if (state_ == BusState::kRunning && parts_.listener.active()) {
    if (auto silent = outcomes_.silent(parts_.listener.silent(now), now, sink))
      reopen(std::move(*silent), {}, now, sink);
  }
  if (state_ != BusState::kStopped && state_ != BusState::kLeased) {
    std::vector<Sample> late;
    parts_.channels.expire(now, late);
    sink.publish(std::move(late));
  }
  parts_.commands.expire(state_, now, sink);
  while (state_ == BusState::kRunning && select_free() && send_next(now, sink)) {}
  if (auto told = overload_.update(parts_.reads.stretch(), now)) sink.push(std::move(*told));
  if (auto draft = parts_.reads.draft()) sink.push(MakePlan{std::move(draft)});
}

void BusEngine::set_timer(ActionSink& sink) {
  Instant next = kNever;
  if (state_ != BusState::kStopped) {
    next = parts_.commands.next_expiry();
    if (state_ != BusState::kLeased) next = std::min(next, parts_.channels.next_expiry());
    for (const Wire& wire : parts_.wires)
      if (wire.exchanging()) next = std::min(next, wire.driver().deadline());
    if (state_ == BusState::kRunning && any_free()) next = std::min(next, next_request_at_);
    if (state_ == BusState::kRunning) next = std::min(next, parts_.listener.next_silence());
  }
  if (next == timer_) return;
  timer_ = next;
  sink.push(SetTimer{next});
}

bool BusEngine::is_too_early(DeviceIndex device) {
  if (parts_.setup.timeless() || parts_.listener.active()) return false;
  const Duration began = parts_.wire().driver().response_began();
  return parts_.devices.too_early(device, began) ||
         parts_.fence.doubts_first(began, parts_.setup.line().characters(1));
}

// If the response is a repetition of the last one, its own follows within the usual time.
Instant BusEngine::repetition_until(Instant now) const {
  const ExchangeDriver& driver = parts_.wire().driver();
  const DeviceIndex device = parts_.wire().flight().asked.device;
  const Duration delay = spec().gap_allowance;
  // Bytes that were read when the response could be complete may have arrived before.
  const Duration read_from = forecast_.waits_for_whole()
                                 ? parts_.devices.earliest_response(device).value_or(Duration{})
                                 : Duration{};
  if (!parts_.late.may_repeat(driver, read_from + delay)) return now;
  return driver.responded() - driver.response_began() +
         parts_.devices.usual_response(device, delay);
}

bool BusEngine::another_asked(ExchangeDriver::Outcome outcome, Instant now, ActionSink& sink) {
  if (!parts_.wire().driver().got_response(outcome)) return false;
  if (!parts_.fence.came_between(parts_.wire().driver().before_response(), now)) return false;
  let_go(now, sink);
  give_up(Cause::kForeignMaster, now, sink);
  return true;
}

void BusEngine::advance(ExchangeDriver::Outcome outcome, Bytes out, Instant now, ActionSink& sink) {
  if (outcome == ExchangeDriver::Outcome::kWaiting) return;
  if (outcome == ExchangeDriver::Outcome::kSend) {
    if (!parts_.fence.keeps(now)) return give_up(Cause::kForeignMaster, now, sink);
    parts_.late.start_anew();
    (void)parts_.fence.sending(out, parts_.wire().driver().sent_until());
    return sink.push(Send{std::move(out), false, parts_.wire().driver().response_baud()});
  }
  if (!out.empty()) {
    (void)parts_.fence.sending(out, parts_.wire().driver().confirmed_until());
    sink.push(Send{std::move(out)});
  }
  const ExchangeDriver& driver = parts_.wire().driver();
  if (parts_.fence.ended(driver.got_response(outcome), driver.received(), now)) let_go(now, sink);
  forecast_.ended(driver, outcome == ExchangeDriver::Outcome::kDone);
  auto lost = outcomes_.conclude(outcome == ExchangeDriver::Outcome::kDone, now, sink);
  if (lost) reopen(std::move(*lost), {}, now, sink);
}

std::optional<Flight> BusEngine::break_off() {
  if (parts_.wire().exchanging()) {
    const Asked& asked = parts_.wire().flight().asked;
    parts_.late.broken_off(asked, parts_.devices.longest_response(asked.device));
  }
  return parts_.wire().abort();
}

void BusEngine::break_all_off() {
  for (Wire& wire : parts_.wires) {
    parts_.select(wire);
    (void)break_off();
  }
}

void BusEngine::give_up(Cause cause, Instant now, ActionSink& sink) {
  const auto broken = break_off();
  if (!broken) return;
  if (broken->is_command())
    parts_.commands.failed(broken->batch, cause, 0, parts_.wire().driver().responded(), now, sink);
  if (broken->kind == Flight::Kind::kRead) parts_.reads.broken_off(broken->block, now);
  outcomes_.count(cause);
}

// Of several exchanges the oldest is that of the device: a gateway responds in order.
void BusEngine::give_all_up(std::optional<Cause> cause, Instant now, ActionSink& sink) {
  const Flight* oldest = nullptr;
  for (const Wire& wire : parts_.wires) {
    if (!wire.exchanging()) continue;
    const Flight& flight = wire.flight();
    if (oldest == nullptr || flight.asked.sent_until < oldest->asked.sent_until) oldest = &flight;
  }
  std::optional<Flight> blamed;
  if (cause && oldest != nullptr) blamed = *oldest;
  for (Wire& wire : parts_.wires) {
    parts_.select(wire);
    give_up(Cause::kPortClosed, now, sink);
  }
  if (blamed) outcomes_.connection_lost(*blamed, *cause, now, sink);
}

void BusEngine::reopen(Reopen action, std::optional<Cause> cause, Instant now, ActionSink& sink) {
  sink.push(std::move(action));
  state_ = BusState::kOpening;
  ++reopened_;
  give_all_up(cause, now, sink);
  for (DeviceIndex device = 0; device < parts_.setup.devices(); ++device) {
    if (parts_.devices.offline(device)) continue;  // its own cause is known
    for (ChannelIndex c = parts_.channels.first_of(device); c < parts_.channels.end_of(device); ++c)
      parts_.channels.failing(c, Cause::kPortClosed, now);
  }
}

// A command is alone on the connection, so no read that began before a write ends after it. Reads
// of the gateway are in flight with those of the plan.
bool BusEngine::select_free() {
  if (!any_free()) return false;
  const auto repeats = std::ranges::find_if(parts_.wires, &Wire::waiting);
  const auto found = repeats != parts_.wires.end()
                         ? repeats
                         : std::ranges::find_if_not(parts_.wires, &Wire::exchanging);
  parts_.select(*found);
  return true;
}

bool BusEngine::send_next(Instant now, ActionSink& sink) {
  WireFence& fence = parts_.fence;
  if (!fence.may_send(now)) {
    next_request_at_ = fence.look_again(now);
    return false;
  }
  auto request = arbiter_.next(now);
  const Instant free_at = parts_.wire().free_at();
  if (!request && now >= free_at && now >= fence.sign_from()) {
    const bool due = now >= fence.sign_due();
    request = arbiter_.sign(now, due);
    if (!request && due) fence.no_sign(now);
  }
  if (!request) {
    const Instant sign = now < fence.sign_from() ? fence.sign_from() : fence.sign_due();
    next_request_at_ = std::min(arbiter_.look_again(), std::max(sign, free_at));
    return false;
  }
  forecast_.begin(!parts_.late.none_owed() || fence.on());
  if (fence.sending(*request, parts_.wire().driver().sent_until())) {
    sink.push(Notice{Notice::Kind::kForeignMasterEnded,
                     {},
                     Cause::kNone,
                     "the wire was silent: this bridge sends again"});
  }
  sink.push(
      Send{std::move(*request), parts_.exchanging() > 1, parts_.wire().driver().response_baud()});
  return true;
}

void BusEngine::let_go(Instant now, ActionSink& sink) {
  outcomes_.count(Cause::kForeignMaster);
  for (ChannelIndex c = 0; c < parts_.channels.size(); ++c)
    parts_.channels.failing(c, Cause::kForeignMaster, now);
  sink.push(Notice{Notice::Kind::kForeignMaster,
                   {},
                   Cause::kForeignMaster,
                   parts_.fence.text() + "; nothing is sent until the wire was silent for " +
                       to_text(parts_.fence.times().listen)});
}

Instant BusEngine::quiet_until() const {
  if (parts_.wires.size() > 1 || !exchanging()) return kLongAgo;
  const Wire& wire = parts_.wire();
  return forecast_.quiet_until(wire.driver(),
                               parts_.devices.earliest_response(wire.flight().asked.device));
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
