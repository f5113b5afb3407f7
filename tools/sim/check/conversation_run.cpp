#include "tools/sim/check/conversation_run.hpp"

#include <algorithm>
#include <stdexcept>

namespace fieldcast::sim {
namespace {

using namespace std::chrono_literals;

constexpr Duration kTimeout = 1s, kGapAllowance = 20ms, kPiece = 1ms;
constexpr int kMostTurns = 100'000;      // of one exchange: more is a hang
constexpr std::size_t kMostRounds = 64;  // more is an exchange without an end

BusSpec bus_of(const Subject& subject) {
  BusSpec bus;
  bus.name = "check";
  bus.port = subject.port;
  bus.devices = {subject.device};
  return bus;
}

RunOutcome finish(Conversation& conversation, Conversation::Outcome how, RunOutcome outcome) {
  outcome.done = how == Conversation::Outcome::kDone;
  outcome.cause =
      how == Conversation::Outcome::kWaiting || how == Conversation::Outcome::kSend ? Cause::kOverlong : conversation.cause();
  outcome.code = conversation.device_code();
  if (outcome.done) outcome.reply = conversation.exchange().reply();
  return outcome;
}

bool ended(Conversation::Outcome outcome) {
  return outcome == Conversation::Outcome::kDone || outcome == Conversation::Outcome::kFailed;
}

}  // namespace

bool RunOutcome::same_as(const RunOutcome& other) const {
  return done == other.done && cause == other.cause && code == other.code &&
         std::ranges::equal(reply, other.reply, [](const RangeReply& a, const RangeReply& b) {
           return a.cause == b.cause && a.device_code == b.device_code && a.items == b.items;
         });
}

std::string RunOutcome::text() const {
  if (!done) return std::string(to_text(cause)) + (code != 0 ? " (code " + std::to_string(code) + ")" : "");
  std::string text = "taken:";
  for (const RangeReply& range : reply) {
    text += range.cause == Cause::kNone ? " [" + to_hex(range.items) + "]" : " [" + std::string(to_text(range.cause)) + "]";
  }
  return text;
}

LiveDevice::LiveDevice(const Subject& subject, const BusFaults& faults) : line_format_(subject.line()) {
  auto bus = SimBus::make(bus_of(subject), faults, 1, now_);
  if (!bus) throw std::runtime_error(bus.error());
  bus_ = std::move(*bus);
  line_ = bus_->open_line();
}

RunOutcome LiveDevice::run(std::unique_ptr<Exchange> exchange) {
  Conversation conversation(line_format_, kGapAllowance, Echo::kAbsent);
  RunOutcome outcome;
  Bytes out;
  auto how = Conversation::Outcome::kWaiting;
  const auto send = [&] {
    line_->receive(out, now_);
    outcome.sent.push_back(out);
    outcome.answers.emplace_back();
    how = Conversation::Outcome::kWaiting;
  };
  conversation.begin(std::move(exchange), kTimeout, true, now_, out);
  send();
  for (int turn = 0; !ended(how) && turn < kMostTurns && outcome.sent.size() <= kMostRounds; ++turn) {
    now_ = std::max(now_, std::min(line_->next_due(), conversation.deadline()));
    Bytes heard;
    line_->advance(now_, heard);
    if (!heard.empty()) {
      append(outcome.answers.back(), heard);
      how = conversation.on_bytes(heard, now_, out);
    } else if (now_ >= conversation.deadline()) {
      how = conversation.on_timer(now_, out);
    }
    if (how == Conversation::Outcome::kSend) send();
  }
  now_ += 200ms;  // the line comes to rest, as between any two requests
  Bytes late;
  line_->advance(now_, late);
  return finish(conversation, how, std::move(outcome));
}

RunOutcome replay(std::unique_ptr<Exchange> exchange, const LineFormat& line, std::span<const Bytes> answers,
                  std::span<const std::size_t> cuts) {
  Conversation conversation(line, kGapAllowance, Echo::kAbsent);
  RunOutcome outcome;
  Bytes out;
  Instant now{};
  conversation.begin(std::move(exchange), kTimeout, true, now, out);
  outcome.sent.push_back(out);
  auto how = Conversation::Outcome::kWaiting;
  for (int turn = 0; !ended(how) && turn < kMostTurns && outcome.sent.size() <= kMostRounds; ++turn) {
    const std::size_t round = outcome.sent.size();
    const Bytes none;
    const Bytes& answer = round <= answers.size() ? answers[round - 1] : none;
    now = std::max(now, conversation.sent_until());
    how = Conversation::Outcome::kWaiting;
    for (std::size_t from = 0, piece = 0; from < answer.size() && how == Conversation::Outcome::kWaiting; ++piece) {
      const std::size_t to = piece < cuts.size() ? std::min(cuts[piece], answer.size()) : answer.size();
      if (to <= from) continue;
      now += kPiece;
      how = conversation.on_bytes(ByteView(answer).subspan(from, to - from), now, out);
      from = to;
    }
    while (how == Conversation::Outcome::kWaiting && turn++ < kMostTurns) {
      now = std::max(now, conversation.deadline());
      how = conversation.on_timer(now, out);
    }
    if (how == Conversation::Outcome::kSend) outcome.sent.push_back(out);
  }
  return finish(conversation, how, std::move(outcome));
}

}  // namespace fieldcast::sim
