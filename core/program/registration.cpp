#include "core/program/registration.hpp"

#include <algorithm>
#include <cassert>

#include "core/program/frame.hpp"
#include "core/protocol/families/registry.hpp"

namespace fieldcast::program {
namespace {

std::string_view trimmed(std::string_view text) {
  const auto is_blank = [](char c) {
    return c == ' ' || c == '\r' || c == '\n' || c == '\t' || c == '\0';
  };
  while (!text.empty() && is_blank(text.front())) text.remove_prefix(1);
  while (!text.empty() && is_blank(text.back())) text.remove_suffix(1);
  return text;
}

std::string printable(std::string_view text) {
  std::string out;
  for (const char c : text.substr(0, 40)) out += c >= ' ' && c <= '~' ? c : '.';
  return out;
}

Registration::Outcome failed(std::string fault) { return {{}, {}, std::move(fault), kNever}; }

}  // namespace

Registration::Registration(const RegistrationRule& rule, Challenge challenge)
    : rule_(rule), challenge_(std::move(challenge)) {
  if (rule.ask != RegistrationRule::Ask::kWords) return;
  const ProtocolEntry* entry = find_protocol(rule.protocol);
  assert(entry != nullptr && "a protocol that is built in");
  DeviceLink link;
  link.address = rule.unit;
  auto made = entry->make(link);
  assert(made && "the loader checks the unit");
  protocol_ = std::move(*made);
}

Registration::Outcome Registration::start(Instant now) {
  deadline_ = now + rule_.timeout;
  if (protocol_) return ask(now);
  Outcome outcome;
  outcome.wake = deadline_;
  if (!challenge_.text.empty())
    append(outcome.send, as_bytes("challenge " + challenge_.text + "\r\n"));
  return outcome;
}

Registration::Outcome Registration::ask(Instant now) {
  const auto address = protocol_->parse_address(rule_.area + std::to_string(rule_.first));
  assert(address && "the loader checks the address");
  received_.clear();
  exchange_ = protocol_->begin(ReadRequest{{Range{address->area, address->first, rule_.words}}},
                               {++tries_});
  Bytes out;
  const Step step = exchange_->start(out);
  return follow(step, std::move(out), now);
}

Registration::Outcome Registration::follow(const Step& step, Bytes out, Instant now) {
  Outcome outcome;
  switch (step.kind) {
    case Step::Kind::kSend:
      received_.clear();
      outcome.send = std::move(out);
      silence_ = now + kResponseTimeout;
      break;
    case Step::Kind::kNeedMore:
      silence_ = now + (step.wait == Wait::kPause ? step.pause : kResponseTimeout);
      break;
    case Step::Kind::kFailed:
      return ask(now);  // noise, or the PLC was busy: retries until the timeout
    case Step::Kind::kDone: {
      const RangeReply& words = exchange_->reply().front();
      return words.cause == Cause::kNone ? number_or_fault(as_text(words.items))
                                         : refused(words.cause, words.device_code);
    }
  }
  outcome.wake = std::min(silence_, deadline_);
  return outcome;
}

Registration::Outcome Registration::on_bytes(ByteView bytes, Instant now) {
  if (protocol_) {
    if (received_.size() + bytes.size() > kMaxText)
      return failed("more bytes arrived than a response to the request for the number");
    append(received_, bytes);
    Bytes out;
    const Step step = exchange_->on_bytes(received_, out);
    if (step.kind == Step::Kind::kFailed &&
        (step.cause == Cause::kDeviceError || step.cause == Cause::kDeviceBusy))
      return refused(step.cause, step.device_code);
    // Retries only after silence, as noise would trigger a storm of requests otherwise.
    if (step.kind != Step::Kind::kFailed) return follow(step, std::move(out), now);
    silence_ = now + kResponseTimeout;
    return {{}, {}, {}, std::min(silence_, deadline_)};
  }
  append(received_, bytes);
  const auto text = as_text(received_);
  const auto begin = text.find_first_not_of("\r\n");
  const auto end = begin == text.npos ? text.npos : text.find_first_of("\r\n", begin);
  if (end != text.npos) return number_or_fault(text.substr(begin, end - begin));
  if (text.size() > kMaxText)
    return failed("a registration text of more than " + std::to_string(kMaxText) + " characters");
  silence_ = now + kTextEnds;
  return {{}, {}, {}, std::min(silence_, deadline_)};
}

Registration::Outcome Registration::on_timer(Instant now) {
  const bool text_ended = !protocol_ && !received_.empty() && now >= silence_;
  if (text_ended) return number_or_fault(as_text(received_));
  if (now >= deadline_)
    return failed(protocol_ ? "the PLC did not send its number in time"
                            : "no registration text came in time");
  if (protocol_ && now >= silence_) {
    Bytes out;
    const Step step = exchange_->on_silence(out);
    return follow(step, std::move(out), now);
  }
  return {{}, {}, {}, std::min(silence_, deadline_)};
}

Registration::Outcome Registration::refused(Cause cause, std::uint16_t code) {
  return failed("the PLC refuses to send its number: " + std::string(fieldcast::to_text(cause)) +
                ' ' + std::to_string(code));
}

Registration::Outcome Registration::number_or_fault(std::string_view text) const {
  std::string_view number = trimmed(text);
  if (!rule_.prefix.empty()) {
    if (!number.starts_with(rule_.prefix)) {
      return failed("the registration text '" + printable(number) + "' does not begin with '" +
                    rule_.prefix + "'");
    }
    number = trimmed(number.substr(rule_.prefix.size()));
  }
  std::string_view response;
  if (!challenge_.text.empty()) {
    const auto blank = std::min(number.find(' '), number.size());
    response = trimmed(number.substr(blank));
    number = number.substr(0, blank);
  }
  if (!is_device_number(number)) return failed("'" + printable(number) + "' is no device number");
  return challenge_.text.empty() ? Outcome{{}, std::string(number), {}, kNever}
                                 : proven(number, response);
}

Registration::Outcome Registration::proven(std::string_view number,
                                           std::string_view response) const {
  const std::string module = "module " + std::string(number);
  if (response.empty()) return failed(module + " does not respond to the challenge");
  if (!challenge_.fits(number, response)) return failed(module + " does not know its secret");
  return {{}, std::string(number), {}, kNever};
}

}  // namespace fieldcast::program
