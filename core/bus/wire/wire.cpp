#include "core/bus/wire/wire.hpp"

#include <algorithm>
#include <cassert>

namespace fieldcast {

namespace {

Echo echo_of(const BusSpec& bus) {
  if (bus.echo) return *bus.echo ? Echo::kPresent : Echo::kAbsent;
  return over_network(bus.port) ? Echo::kAbsent : Echo::kUnknown;
}

}  // namespace

Wire::Wire(const BusSetup& setup, Bytes& session)
    : setup_(setup),
      driver_(setup.line(), setup.spec().gap_allowance, echo_of(setup.spec())),
      session_(session) {
  const auto* rule = std::get_if<LearnedSilence>(&setup.spec().silence);
  if (rule != nullptr)
    learning_.emplace(setup.silence(), least_silence(*rule, setup.line()), setup.devices());
}

void Wire::launch(Flight flight) {
  assert(!flight_);
  flight_ = std::move(flight);
}

Bytes Wire::send(const Send& with, Instant now) {
  assert(waiting());
  Asked& asked = flight_->asked;
  if (flight_->tries == 0)
    flight_->started = now;
  else
    flight_->idle += now - free_at_;
  looked_ = now;
  rest_ = ended_ == kLongAgo ? Duration::max() : now - ended_;
  flight_->rest = with.rest;
  asked.context = with.context;
  asked.context.session = &session_;
  strays_since_ = kNever;
  ++exchanges_;
  EqualBytes equal = EqualBytes::kEcho;
  if (driver_.echo() == Echo::kUnknown && !setup_.response_differs(asked.device, asked.request))
    equal = std::holds_alternative<ReadRequest>(asked.request) ? EqualBytes::kDoubtful
                                                               : EqualBytes::kResponse;
  Bytes out;
  driver_.begin(setup_.protocol(asked.device).begin(asked.request, asked.context), with.timeout,
                equal, now, out);
  asked.sent_until = driver_.sent_until();
  return out;
}

// Time after the deadline shows that this process was suspended; it is not the device's.
void Wire::look(Instant now) {
  const Instant since = std::max(driver_.deadline(), looked_);
  if (now > since) flight_->idle += now - since;
  looked_ = now;
}

ExchangeDriver::Outcome Wire::on_bytes(ByteView bytes, Instant now, Bytes& out) {
  look(now);
  const auto outcome = driver_.on_bytes(bytes, now, out);
  flight_->asked.sent_until = driver_.sent_until();
  return outcome;
}

ExchangeDriver::Outcome Wire::on_frame(ByteView frame, Instant now, Bytes& out) {
  look(now);
  const auto outcome = driver_.on_frame(frame, now, out);
  if (outcome == ExchangeDriver::Outcome::kWaiting) wait_on();
  return outcome;
}

ExchangeDriver::Outcome Wire::on_timer(Instant now, Bytes& out) {
  look(now);
  const auto outcome = driver_.on_timer(now, out);
  flight_->asked.sent_until = driver_.sent_until();
  return outcome;
}

void Wire::wait_on() {
  const Asked& asked = flight_->asked;
  driver_.wait_on(setup_.protocol(asked.device).begin(asked.request, asked.context));
}

ExchangeDriver::Outcome Wire::wait_on(std::size_t size, Instant now, Bytes& out) {
  const Asked& asked = flight_->asked;
  return driver_.wait_on(setup_.protocol(asked.device).begin(asked.request, asked.context), size,
                         now, out);
}

Wire::Ended Wire::conclude(bool done, Instant now) {
  Ended ended;
  ended.done = done;
  ended.cause = done ? Cause::kNone : driver_.cause();
  ended.without_response = done && driver_.without_response();
  ended.responded = (done && !ended.without_response) || ended.cause == Cause::kDeviceError ||
                    ended.cause == Cause::kDeviceBusy;
  ended.device_code = driver_.device_code();
  ended.exchange = driver_.finish();
  ended_ = std::max(now, driver_.confirmed_until());
  if (learning_ && !ended.without_response)
    learning_->ended(flight_->asked.device, rest_, ended.responded);
  free_at_ = ended_ + silence();
  spent_ = free_at_ - flight_->started;
  ended.spent = spent_ - flight_->idle;
  if (ended.cause == Cause::kNoResponse || ended.cause == Cause::kTruncated)
    flight_->no_response = true;
  return ended;
}

void Wire::repeat() { ++flight_->tries; }

Flight Wire::take() {
  load_.ended(spent_, flight_->kind == Flight::Kind::kRead);
  Flight flight = std::move(*flight_);
  flight_.reset();
  return flight;
}

std::optional<Flight> Wire::abort() {
  driver_.abort();
  return std::exchange(flight_, std::nullopt);
}

Flight Wire::not_sent(Instant now) {
  assert(first_request());
  --exchanges_;
  driver_.not_sent();
  free_at_ = now + kNotSentRest;
  return *std::exchange(flight_, std::nullopt);
}

void Wire::stray(Instant now) {
  if (strays_since_ == kNever) strays_since_ = now;
  if (now - strays_since_ < kLongestStray) free_at_ = std::max(free_at_, now + setup_.silence());
}

WireLoad::Shares Wire::shares(Instant now) {
  if (!flight_) return load_.report(Duration::zero(), false, now);
  return load_.report(now - flight_->started, flight_->kind == Flight::Kind::kRead, now);
}

}  // namespace fieldcast
