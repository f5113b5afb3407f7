#include "core/bus/wire/exchange_driver.hpp"

#include <algorithm>
#include <utility>

namespace fieldcast {

void ExchangeDriver::begin(std::unique_ptr<Exchange> exchange, Duration timeout, EqualBytes equal,
                           Instant now, Bytes& out) {
  exchange_ = std::move(exchange);
  timeout_ = timeout;
  equal_ = equal;
  ended_in_silence_ = false;
  cause_ = Cause::kNone;
  device_code_ = 0;
  requests_ = 0;
  out.clear();
  const Step step = exchange_->start(out);
  sending(step, now, out);
}

void ExchangeDriver::sending(const Step& step, Instant now, const Bytes& out) {
  ++requests_;
  held_ = Outcome::kWaiting;
  sent_ = out;
  received_.clear();
  echo_stripped_ = echo_ == Echo::kAbsent;
  missing_ = 0;
  expected_ = step.characters;
  response_line_.baud = step.response_baud == 0 ? line_.baud : step.response_baud;
  bytes_sent_ += out.size();
  sent_until_ = now + line_.characters(static_cast<double>(out.size()));
  response_deadline_ = sent_until_ + timeout_;
  hard_deadline_ =
      response_deadline_ + response_line_.characters(1.25 * step.characters) + 2 * gap_allowance_;
  without_response_ = step.wait == Wait::kPause;
  deadline_ = without_response_ ? sent_until_ + step.pause : response_deadline_;
  last_byte_ = now;
}

bool ExchangeDriver::strip_echo() {
  if (echo_stripped_) return true;
  const std::size_t common = std::min(received_.size(), sent_.size());
  const bool same = std::equal(
      received_.begin(), received_.begin() + static_cast<std::ptrdiff_t>(common), sent_.begin());
  if (!same) {
    // Not an echo. The exchange resynchronises if noise broke the echo.
    echo_stripped_ = true;
    return true;
  }
  // An echo, or a response that begins the same.
  if (received_.size() < sent_.size()) return false;
  if (echo_ == Echo::kUnknown && equal_ == EqualBytes::kResponse) return true;
  // A response is not accepted here either: the next request of another size decides.
  if (echo_ == Echo::kUnknown && equal_ == EqualBytes::kDoubtful &&
      received_.size() == sent_.size())
    return false;
  echo_ = Echo::kPresent;
  received_.erase(received_.begin(), received_.begin() + static_cast<std::ptrdiff_t>(sent_.size()));
  echo_stripped_ = true;
  return !received_.empty();
}

ExchangeDriver::Outcome ExchangeDriver::on_bytes(ByteView bytes, Instant now, Bytes& out) {
  bytes_received_ += bytes.size();
  last_byte_ = now;
  if (received_.size() + bytes.size() > kMaxReceived)
    return follow(Step::failed(Cause::kOverlong), now, out);
  append(received_, bytes);
  if (!strip_echo()) {
    deadline_ = std::max(
        deadline_,
        std::min(now + line_.characters(static_cast<double>(sent_.size())) + gap_allowance_,
                 hard_deadline_));
    return Outcome::kWaiting;
  }
  out.clear();
  ended_in_silence_ = false;
  return follow(exchange_->on_bytes(received_, out), now, out);
}

ExchangeDriver::Outcome ExchangeDriver::on_frame(ByteView frame, Instant now, Bytes& out) {
  received_.assign(frame.begin(), frame.end());
  out.clear();
  Step step = exchange_->on_bytes(frame, out);
  ended_in_silence_ = step.kind == Step::Kind::kNeedMore;
  if (ended_in_silence_) step = exchange_->on_silence(out);
  const bool foreign = step.kind == Step::Kind::kFailed &&
                       (step.cause == Cause::kForeign || step.cause == Cause::kNoResponse);
  if (foreign) return Outcome::kWaiting;
  bytes_received_ += frame.size();
  last_byte_ = now;
  return follow(step, now, out);
}

ExchangeDriver::Outcome ExchangeDriver::on_timer(Instant now, Bytes& out) {
  out.clear();
  if (holds()) {
    deadline_ = kNever;
    return std::exchange(held_, Outcome::kWaiting);
  }
  ended_in_silence_ = true;
  return follow(exchange_->on_silence(out), now, out);
}

ExchangeDriver::Outcome ExchangeDriver::follow(const Step& step, Instant now, Bytes& out) {
  missing_ =
      step.kind == Step::Kind::kNeedMore && step.wait == Wait::kRestOfFrame ? step.characters : 0;
  switch (step.kind) {
    case Step::Kind::kSend: sending(step, now, out); return Outcome::kSend;
    case Step::Kind::kNeedMore:
      switch (step.wait) {
        case Wait::kResponse: deadline_ = response_deadline_; break;
        case Wait::kRestOfFrame:
          deadline_ = std::min(now + response_line_.characters(step.characters) + gap_allowance_,
                               hard_deadline_);
          break;
        // The pause starts after the end of the request, even if bytes arrived during it.
        case Wait::kPause: deadline_ = std::max(now, sent_until_) + step.pause; break;
      }
      return Outcome::kWaiting;
    case Step::Kind::kDone:
    case Step::Kind::kFailed: break;
  }
  const bool done = step.kind == Step::Kind::kDone;
  bytes_sent_ += out.size();
  confirmed_until_ = now + line_.characters(static_cast<double>(out.size()));
  cause_ = step.cause;
  device_code_ = step.device_code;
  deadline_ = kNever;
  // An echo does not depend on a device, so a whole exchange or silence without one excludes it.
  if (echo_ == Echo::kUnknown && !echo_stripped_ && received_.size() < sent_.size() && !done)
    echo_ = received_.empty() ? Echo::kAbsent : echo_;
  // A response without an echo shows the same. A refusal never equals its request.
  const bool refused = cause_ == Cause::kDeviceError || cause_ == Cause::kDeviceBusy;
  if (echo_ == Echo::kUnknown && ((done && equal_ != EqualBytes::kResponse) || refused))
    echo_ = Echo::kAbsent;
  return done ? Outcome::kDone : Outcome::kFailed;
}

void ExchangeDriver::wait_on(std::unique_ptr<Exchange> again) {
  exchange_ = std::move(again);
  Bytes same;
  (void)exchange_->start(same);
  received_.clear();
  held_ = Outcome::kWaiting;
  missing_ = 0;
  cause_ = Cause::kNone;
  device_code_ = 0;
  deadline_ = response_deadline_;
}

ExchangeDriver::Outcome ExchangeDriver::wait_on(std::unique_ptr<Exchange> again, std::size_t size,
                                                Instant now, Bytes& out) {
  const Bytes rest(received_.begin() + static_cast<std::ptrdiff_t>(size), received_.end());
  wait_on(std::move(again));
  if (rest.empty()) return Outcome::kWaiting;
  received_ = rest;
  out.clear();
  return follow(exchange_->on_bytes(received_, out), now, out);
}

Duration ExchangeDriver::response_time() const {
  return last_byte_ - sent_until_ -
         response_line_.characters(static_cast<double>(received_.size()));
}

Duration ExchangeDriver::response_began() const {
  const std::size_t response =
      expected_ > 0 ? std::min<std::size_t>(received_.size(), expected_) : received_.size();
  return last_byte_ - sent_until_ - response_line_.characters(static_cast<double>(response));
}

}  // namespace fieldcast
