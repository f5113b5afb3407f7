// The course of a scan, as a state machine: next() returns the next request, answered() takes its
// outcome. The first line on which a device responds is the line; no other line is searched. Each
// address that was silent there gets a second, different request.
//
// Lines with probes are searched quickly: each line is probed, and searched only if a byte was
// received on it. Bytes that are not a valid response must be received twice, since some adapters
// deliver one when they change the baud rate. Pure; one owner.
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
  std::size_t question = 0;        // index in questions_of(); the last one where there are fewer
  std::optional<Duration> wait{};  // for the response to a probe; empty: the usual timeout
  bool first = false;              // of a line's probes or search: the line must be quiet before
};

struct ScanAnswer {
  bool device = false;            // a device answered: with a value, or by refusing
  Cause cause = Cause::kNone;     // of a refusal; of no answer
  std::uint16_t device_code = 0;  // of a refusal
  Duration took{};
  std::size_t bytes = 0;    // that came at all
  bool echo_alone = false;  // they are those that were sent: the adapter's, nobody else speaks
  bool heard = false;       // since the first probe of the line: bytes other than the echo
  AnswerShape shape = AnswerShape::kOther;  // of a broken answer
};

struct ScanFound {
  std::size_t line = 0;
  std::uint16_t address = 1;
  std::size_t question = 0;
  ScanAnswer answer;
  std::string identity;                  // what the device says of itself; empty: nothing
  std::vector<std::string> templates{};  // that fit the identity; more than one: all of them may
  std::optional<SunSpecMap> sunspec{};   // its SunSpec models
};

// An address from which broken answers come that begin like valid ones: the settings of the line
// are probably right.
struct ScanBroken {
  std::size_t line = 0;
  std::uint16_t address = 1;
  AnswerShape shape = AnswerShape::kWhole;
};

class Scanner {
 public:
  // So many questions in a row that brought bytes and no answer: somebody else speaks there. Once
  // more in the second pass, and the line is left at once.
  static constexpr unsigned kBabble = 8;

  explicit Scanner(std::vector<ScanLine> lines);

  // Nothing: the scan is over.
  [[nodiscard]] std::optional<ScanAsk> next() const;
  // To what next() said.
  void answered(const ScanAnswer& answer);
  // The line of next() cannot be asked (its port does not take the settings): it is left out.
  void skip_line();

  [[nodiscard]] const std::vector<ScanLine>& lines() const { return lines_; }
  [[nodiscard]] const std::vector<ScanFound>& found() const { return found_; }
  void set_identity(std::size_t found, std::string identity) {
    found_[found].identity = std::move(identity);
  }
  void set_sunspec(std::size_t found, SunSpecMap map) { found_[found].sunspec = std::move(map); }
  void set_templates(std::size_t found, std::vector<std::string> templates) {
    found_[found].templates = std::move(templates);
  }
  [[nodiscard]] std::size_t asked() const { return asked_; }
  // That are still to be asked, unless a device answers.
  [[nodiscard]] std::size_t left() const;
  // The lines on which bytes came that were no answer.
  [[nodiscard]] const std::vector<std::size_t>& noisy_lines() const { return noisy_; }
  // Addresses whose answers are broken, without those that answered another question.
  [[nodiscard]] std::vector<ScanBroken> broken() const;
  // What was sent came back, and nothing else.
  [[nodiscard]] bool echoed() const { return echoed_; }
  // Every line was probed, and no byte of another sender was received on any of them.
  [[nodiscard]] bool silent() const { return quick_ && over() && !heard_any_; }

 private:
  void advance();
  void next_line();
  void probed(const ScanAnswer& answer);
  void search_or_probe_next();
  [[nodiscard]] bool babbles() const;
  [[nodiscard]] bool over() const { return pass_ == kPasses; }

  static constexpr std::size_t kPasses = 2;
  std::vector<ScanLine> lines_;
  std::vector<ScanFound> found_;
  std::vector<std::size_t> noisy_;
  std::vector<ScanBroken> broken_;
  std::vector<std::size_t> babbling_;   // left in the first pass
  std::optional<std::size_t> settled_;  // the line on which a device answered
  std::size_t pass_ = 0, line_ = 0, index_ = 0, asked_ = 0;
  unsigned babble_ = 0;
  bool echoed_ = false;
  bool quick_ = false;       // lines have probes
  bool probing_ = false;     // as opposed to searching
  bool heard_once_ = false;  // on the line that is probed
  bool heard_any_ = false;
};

}  // namespace fieldcast::cli
