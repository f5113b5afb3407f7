// The answers of the simulated device, disturbed in every single way: the same value comes out, or
// none.
#include <fmt/format.h>

#include <numeric>

#include "tools/sim/check/requests.hpp"
#include "tools/sim/check/sim_check.hpp"

namespace fieldcast::sim {
namespace {

constexpr int kNoiseRounds = 200;
constexpr std::size_t kMostFlipped =
    160;  // characters of an answer in which every bit is flipped; beyond, one bit of each

class AnswerCheck {
 public:
  AnswerCheck(const Subject& subject, CheckRows& rows)
      : subject_(subject), requests_(subject), live_(subject), rows_(rows) {}

  void run() {
    const std::size_t first = rows_.size();
    for (const char* check : {"splits", "truncations", "flipped bits", "noise before"})
      rows_.push_back({.check = check, .where = "answers"});
    splits_ = &rows_[first], cuts_ = &rows_[first + 1], flips_ = &rows_[first + 2],
    noise_ = &rows_[first + 3];
    for (const NamedRequest& example : requests_.examples()) disturb(example);
    if (!subject_.checked) {
      flips_->note = fmt::format("answers carry no check: {} flipped bits pass unseen", unseen_);
      noise_->note = "answers carry no check";
    }
  }

 private:
  void disturb(const NamedRequest& example) {
    const std::uint16_t sequence = ++sequence_;
    const auto begin = [&] { return requests_.protocol().begin(example.request, {sequence}); };
    const RunOutcome clean = live_.run(begin());
    if (!clean.done && clean.cause != Cause::kDeviceError) {
      splits_->fail(fmt::format("{}: the undisturbed answer: {}", example.name, clean.text()),
                    to_hex(clean.answers.back()));
      return;
    }
    const auto run = [&](const std::vector<Bytes>& answers,
                         const std::vector<std::size_t>& cuts = {}) {
      return replay(begin(), subject_.line(), answers, cuts);
    };
    const auto judge = [&](CheckRow& row, const RunOutcome& outcome, bool right,
                           const std::string& what, const Bytes& frame) {
      right ? row.pass()
            : row.fail(fmt::format("{}, {}: {}; undisturbed: {}", example.name, what,
                                   outcome.text(), clean.text()),
                       to_hex(frame));
    };
    for (std::size_t round = 0; round < clean.answers.size(); ++round) {
      const Bytes& answer = clean.answers[round];
      const std::string in_round =
          clean.answers.size() > 1 ? fmt::format(" of answer {}", round + 1) : "";
      for (std::size_t cut = 0; cut < answer.size(); ++cut) {
        std::vector<std::size_t> cuts{cut};
        if (cut == 0)
          cuts.resize(answer.size()), std::iota(cuts.begin(), cuts.end(), 1);  // byte by byte
        const RunOutcome outcome = run(clean.answers, cuts);
        judge(*splits_, outcome, outcome.same_as(clean),
              fmt::format("split at {}{}", cut, in_round), answer);
      }
      for (std::size_t size = 0; size < answer.size(); ++size) {
        auto answers = clean.answers;
        answers.resize(round + 1);
        answers[round].resize(size);
        const RunOutcome outcome = run(answers);
        judge(*cuts_, outcome, !outcome.says_something(),
              fmt::format("cut to {}{}", size, in_round), answers[round]);
      }
      for (std::size_t bit = 0; bit<answer.size() * 8; bit += answer.size()> kMostFlipped ? 9 : 1) {
        auto answers = clean.answers;
        answers[round][bit / 8] ^= static_cast<std::uint8_t>(1u << bit % 8);
        const RunOutcome outcome = run(answers);
        const bool right = !outcome.says_something() || outcome.same_as(clean);
        unseen_ += right ? 0 : 1;
        judge(*flips_, outcome, right || !subject_.checked,
              fmt::format("bit {} of byte {}{} flipped", bit % 8, bit / 8, in_round),
              answers[round]);
      }
    }
    for (int round = 0; round < kNoiseRounds; ++round) {
      auto answers = clean.answers;
      Bytes noise(1 + random_() % 12);
      for (std::uint8_t& byte : noise) byte = static_cast<std::uint8_t>(random_());
      answers.front().insert(answers.front().begin(), noise.begin(), noise.end());
      const RunOutcome outcome = run(answers);
      judge(*noise_, outcome,
            !outcome.says_something() || outcome.same_as(clean) || !subject_.checked,
            "behind " + to_hex(noise), answers.front());
    }
  }

  const Subject& subject_;
  Requests requests_;
  LiveDevice live_;
  CheckRows& rows_;
  CheckRow *splits_ = nullptr, *cuts_ = nullptr, *flips_ = nullptr, *noise_ = nullptr;
  std::uint64_t unseen_ = 0;
  std::uint16_t sequence_ = 0;
  std::mt19937 random_{20};
};

}  // namespace

void check_answers(const Subject& subject, CheckRows& rows) { AnswerCheck(subject, rows).run(); }

}  // namespace fieldcast::sim
