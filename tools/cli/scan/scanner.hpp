// The course of a scan, as a state machine: next() says what to ask, answered() what came of it.
// The first line on which a device answers is the line; the others are not asked any more. Whoever
// was silent there is asked once more, with another question. Pure; one owner.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "core/base/cause.hpp"
#include "core/base/time.hpp"
#include "core/bus/garbage.hpp"
#include "tools/cli/scan/scan_plan.hpp"
#include "tools/cli/scan/sunspec_walk.hpp"

namespace fieldcast::cli {

struct ScanAsk {
  std::size_t line = 0;  // index in the lines
  std::uint16_t address = 1;
  std::size_t question = 0;  // index in questions_of(); the last one where there are fewer
};

struct ScanAnswer {
  bool device = false;            // a device responded with a value or an error
  Cause cause = Cause::kNone;     // of an error or a missing response
  std::uint16_t device_code = 0;  // of an error
  Duration took{};
  std::size_t bytes = 0;    // received
  bool echo_alone = false;  // they are those that were sent: the adapter's, nobody else speaks
  AnswerShape shape = AnswerShape::kOther;  // of a broken answer
};

struct ScanFound {
  std::size_t line = 0;
  std::uint16_t address = 1;
  std::size_t question = 0;
  ScanAnswer answer;
  std::string identity;               // what the device says of itself; empty: nothing
  std::optional<SunSpecMap> sunspec;  // its SunSpec models
};

// An address with invalid responses that start like valid ones: the settings of the line are
// probably correct.
struct ScanBroken {
  std::size_t line = 0;
  std::uint16_t address = 1;
  AnswerShape shape = AnswerShape::kWhole;
};

class Scanner {
 public:
  // Consecutive requests with bytes but no valid response: the line has other traffic. The second
  // pass leaves the line immediately.
  static constexpr unsigned kBabble = 8;

  explicit Scanner(std::vector<ScanLine> lines);

  // Empty at the end of the scan.
  [[nodiscard]] std::optional<ScanAsk> next() const;
  // Result of the request of next().
  void answered(const ScanAnswer& answer);
  // Skips the line of next(), because its port does not accept the settings.
  void skip_line();

  [[nodiscard]] const std::vector<ScanLine>& lines() const { return lines_; }
  [[nodiscard]] const std::vector<ScanFound>& found() const { return found_; }
  void set_identity(std::size_t found, std::string identity) {
    found_[found].identity = std::move(identity);
  }
  void set_sunspec(std::size_t found, SunSpecMap map) { found_[found].sunspec = std::move(map); }
  [[nodiscard]] std::size_t asked() const { return asked_; }
  // Remaining requests if no device responds.
  [[nodiscard]] std::size_t left() const;
  // Lines with bytes that were not a valid response.
  [[nodiscard]] const std::vector<std::size_t>& noisy_lines() const { return noisy_; }
  // Addresses with only invalid responses, without those with a valid one to the second request.
  [[nodiscard]] std::vector<ScanBroken> broken() const;
  // All received bytes were an echo.
  [[nodiscard]] bool echoed() const { return echoed_; }

 private:
  void advance();
  void next_line();
  [[nodiscard]] bool babbles() const;
  [[nodiscard]] bool over() const { return pass_ == kPasses; }

  static constexpr std::size_t kPasses = 2;
  std::vector<ScanLine> lines_;
  std::vector<ScanFound> found_;
  std::vector<std::size_t> noisy_;
  std::vector<ScanBroken> broken_;
  std::vector<std::size_t> babbling_;   // left in the first pass
  std::optional<std::size_t> settled_;  // line with a response
  std::size_t pass_ = 0, line_ = 0, index_ = 0, asked_ = 0;
  unsigned babble_ = 0;
  bool echoed_ = false;
};

}  // namespace fieldcast::cli
