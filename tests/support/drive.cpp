#include "tests/support/drive.hpp"

#include <algorithm>
#include <numeric>

namespace fieldcast::test {
namespace {

constexpr std::size_t kMaxRounds = 64;
constexpr std::size_t kMaxSilences = 64;

class Driver {
 public:
  explicit Driver(Exchange& exchange) : exchange_(exchange) {}

  void start() {
    Bytes out;
    take(exchange_.start(out), out);
  }
  // Returns true while the round of the last send continues.
  bool show(ByteView prefix) {
    const std::size_t round = outcome_.sent.size();
    Bytes out;
    outcome_.used = prefix.size();
    take(exchange_.on_bytes(prefix, out), out);
    return !ended_ && outcome_.sent.size() == round;
  }
  void silence() {
    Bytes out;
    outcome_.waited = true;
    take(exchange_.on_silence(out), out);
  }
  [[nodiscard]] bool ended() const { return ended_; }
  [[nodiscard]] std::size_t rounds() const { return outcome_.sent.size(); }
  Outcome outcome() {
    if (!ended_) {
      outcome_.kind = Step::Kind::kFailed;
      outcome_.cause = Cause::kOverlong;
    }
    if (outcome_.done()) outcome_.reply = exchange_.reply();
    return std::move(outcome_);
  }

 private:
  void take(const Step& step, Bytes& out) {
    switch (step.kind) {
      case Step::Kind::kSend: outcome_.sent.push_back(out); break;
      case Step::Kind::kNeedMore: break;
      case Step::Kind::kDone:
      case Step::Kind::kFailed:
        outcome_.kind = step.kind;
        outcome_.cause = step.cause;
        outcome_.code = step.device_code;
        outcome_.confirmation = out;
        ended_ = true;
    }
  }

  Exchange& exchange_;
  Outcome outcome_;
  bool ended_ = false;
};

}  // namespace

Outcome drive(Exchange& exchange, std::span<const Bytes> answers,
              std::span<const std::size_t> cuts) {
  Driver driver(exchange);
  driver.start();
  std::size_t silences = 0;
  while (!driver.ended() && driver.rounds() <= kMaxRounds && silences < kMaxSilences) {
    const std::size_t round = driver.rounds();
    const Bytes none;
    const Bytes& answer = round <= answers.size() ? answers[round - 1] : none;
    bool on = true;
    for (const std::size_t cut : cuts) {
      if (on && cut > 0 && cut < answer.size()) on = driver.show(ByteView(answer).first(cut));
    }
    if (on && !answer.empty()) on = driver.show(answer);
    while (on && !driver.ended() && driver.rounds() == round && silences++ < kMaxSilences)
      driver.silence();
  }
  return driver.outcome();
}

Outcome drive(Exchange& exchange, const Bytes& answer) {
  return drive(exchange, std::span(&answer, 1));
}

Outcome drive_bytewise(Exchange& exchange, std::span<const Bytes> answers) {
  std::size_t longest = 0;
  for (const Bytes& answer : answers) longest = std::max(longest, answer.size());
  std::vector<std::size_t> cuts(longest);
  std::iota(cuts.begin(), cuts.end(), 0);
  return drive(exchange, answers, cuts);
}

std::string to_text(const Outcome& outcome) {
  if (!outcome.done())
    return "failed: " + std::string(to_text(outcome.cause)) + " code " +
           std::to_string(outcome.code);
  std::string text = "done:";
  for (const RangeReply& range : outcome.reply)
    text += " [" + std::string(to_text(range.cause)) + " " + to_hex(range.items) + "]";
  return text;
}

}  // namespace fieldcast::test
