#include "tests/support/matrix.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>

namespace fieldcast::test {
namespace {

bool same(const Outcome& a, const Outcome& b) {
  if (a.kind != b.kind || a.cause != b.cause || a.code != b.code ||
      a.reply.size() != b.reply.size())
    return false;
  return std::equal(a.reply.begin(), a.reply.end(), b.reply.begin(),
                    [](const RangeReply& x, const RangeReply& y) {
                      return x.cause == y.cause && x.device_code == y.device_code &&
                             x.items == y.items;
                    });
}

// A refusal is a distinct outcome: a disturbed response must not become one.
bool says_something(const Outcome& outcome) {
  return outcome.done() || outcome.cause == Cause::kDeviceError ||
         outcome.cause == Cause::kDeviceBusy;
}

class Matrix {
 public:
  explicit Matrix(const MatrixCase& matrix) : case_(matrix), clean_(run(matrix.answers)) {}

  void splits() {
    EXPECT_TRUE(says_something(clean_)) << "the undisturbed response: " << to_text(clean_);
    const auto exchange = case_.begin();
    expect_same(drive_bytewise(*exchange, case_.answers), "byte by byte");
    for (const Bytes& answer : case_.answers) {
      for (std::size_t cut = 1; cut < answer.size(); ++cut) {
        expect_same(run(case_.answers, {cut}), "split at " + std::to_string(cut));
      }
    }
  }

  void truncations() {
    for (std::size_t round = 0; round < case_.answers.size(); ++round) {
      for (std::size_t size = 0; size < case_.answers[round].size(); ++size) {
        auto answers = case_.answers;
        answers.resize(round + 1);
        answers[round].resize(size);
        const Outcome outcome = run(answers);
        EXPECT_FALSE(says_something(outcome))
            << "round " << round << " cut to " << size << " bytes: " << to_text(outcome);
      }
    }
  }

  void flips() {
    for (std::size_t round = 0; round < case_.answers.size(); ++round) {
      for (std::size_t bit = 0; bit < case_.answers[round].size() * 8; ++bit) {
        auto answers = case_.answers;
        answers[round][bit / 8] ^= static_cast<std::uint8_t>(1u << bit % 8);
        const std::string what = "round " + std::to_string(round) + " byte " +
                                 std::to_string(bit / 8) + " bit " + std::to_string(bit % 8);
        expect_refused_or_same(run(answers), what);
        const auto exchange = case_.begin();
        expect_refused_or_same(drive_bytewise(*exchange, answers), what + ", byte by byte");
      }
    }
  }

  void noise() {
    std::mt19937 random(20);
    for (int round = 0; round < 500; ++round) {
      auto answers = case_.answers;
      Bytes noise(1 + random() % 12);
      for (auto& byte : noise) byte = static_cast<std::uint8_t>(random());
      answers.front().insert(answers.front().begin(), noise.begin(), noise.end());
      const Outcome outcome = run(answers);
      if (case_.noise_recovers)
        expect_same(outcome, "after noise " + to_hex(noise));
      else
        expect_refused_or_same(outcome, "after noise " + to_hex(noise));
    }
  }

  void random_bytes(unsigned seed, int rounds) {
    std::mt19937 random(seed);
    for (int round = 0; round < rounds; ++round) {
      std::vector<Bytes> answers = case_.answers;
      for (Bytes& answer : answers) spoil(answer, random);
      expect_refused_or_same(run(answers), "random " + to_hex(answers.front()));
    }
  }

 private:
  Outcome run(const std::vector<Bytes>& answers, const std::vector<std::size_t>& cuts = {}) const {
    const auto exchange = case_.begin();
    return drive(*exchange, answers, cuts);
  }
  void expect_same(const Outcome& outcome, const std::string& what) const {
    EXPECT_TRUE(same(outcome, clean_))
        << what << ": " << to_text(outcome) << ", undisturbed: " << to_text(clean_);
  }
  void expect_refused_or_same(const Outcome& outcome, const std::string& what) const {
    if (case_.checked && says_something(outcome)) expect_same(outcome, what);
  }

  // Replaces all by random bytes, or overwrites, removes or doubles one span of the response.
  static void spoil(Bytes& answer, std::mt19937& random) {
    const auto fill = [&](Bytes& bytes) {
      for (auto& byte : bytes) byte = static_cast<std::uint8_t>(random());
    };
    if (random() % 3 == 0 || answer.size() < 4) {
      answer.resize(random() % 300);
      return fill(answer);
    }
    const auto first = static_cast<std::ptrdiff_t>(random() % answer.size());
    const auto last = std::min(first + 1 + static_cast<std::ptrdiff_t>(random() % 8),
                               static_cast<std::ptrdiff_t>(answer.size()));
    Bytes span(answer.begin() + first, answer.begin() + last);
    switch (random() % 3) {
      case 0: answer.erase(answer.begin() + first, answer.begin() + last); break;
      case 1: answer.insert(answer.begin() + last, span.begin(), span.end()); break;
      default: fill(span); std::copy(span.begin(), span.end(), answer.begin() + first);
    }
  }

  const MatrixCase& case_;
  const Outcome clean_;
};

}  // namespace

void expect_matrix(const MatrixCase& matrix) {
  Matrix cells(matrix);
  cells.splits();
  cells.truncations();
  cells.flips();
  cells.noise();
}

void expect_random_bytes_are_refused(const MatrixCase& matrix, unsigned seed, int rounds) {
  Matrix(matrix).random_bytes(seed, rounds);
}

}  // namespace fieldcast::test
