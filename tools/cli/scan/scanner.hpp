// State machine of a scan: next() returns the next request, on_response() processes its result. The
// scan settles on the first line with a response and skips the others. Silent addresses there get a
// second, different request. A line with bytes that are no response is searched once more: some
// devices respond late to the first request after noise, as if another was asked.
//
// Quick search, if the lines have probes: each line is probed, and searched only if a byte was
// received. Bytes that are not a valid response must be received twice, because some adapters
// deliver one after a change of the baud rate. Pure.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "core/base/cause.hpp"
#include "core/base/time.hpp"
#include "core/bus/health/garbage.hpp"
#include "tools/cli/scan/scan_plan.hpp"
#include "tools/cli/scan/sunspec_walk.hpp"

namespace fieldcast::cli {

struct ScanAsk {
  std::size_t line = 0;  // index in the lines
  std::uint16_t address = 1;
  std::size_t question = 0;        // index in questions_of(); the last one if there are fewer
  std::optional<Duration> wait{};  // for the response to a probe; empty: usual timeout
  bool first = false;              // first probe or request of a line, which must be silent before
};

struct ScanResponse {
  bool device = false;            // a device responded with a value or an error
  Cause cause = Cause::kNone;     // of an error or a missing response
  std::uint16_t device_code = 0;  // of an error
  Duration took{};
  std::size_t bytes = 0;    // received
  bool echo_alone = false;  // only the sent bytes were received: an echo of the adapter
  bool heard = false;       // bytes other than an echo since the line's first probe
  ResponseShape shape = ResponseShape::kOther;  // of an invalid response
};

struct ScanFound {
  std::size_t line = 0;
  std::uint16_t address = 1;
  std::size_t question = 0;
  ScanResponse response;
  std::string identity;                  // identification text of the device; empty: none
  std::vector<std::string> templates{};  // that match the identity equally well
  std::optional<SunSpecMap> sunspec{};
};

// An address with invalid responses that start like valid ones: the settings of the line are
// probably correct.
struct ScanBroken {
  std::size_t line = 0;
  std::uint16_t address = 1;
  ResponseShape shape = ResponseShape::kWhole;
};

class Scanner {
 public:
  // Consecutive requests with bytes but no valid response: the line has other traffic. The second
  // pass leaves the line immediately.
  static constexpr unsigned kBabble = 8;

  explicit Scanner(std::vector<ScanLine> lines);

  // Empty at the end of the scan.
  [[nodiscard]] std::optional<ScanAsk> next() const;
  void on_response(const ScanResponse& response);
  // Skips the line of next(), because its port does not accept the settings.
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
  [[nodiscard]] std::size_t left() const;
  [[nodiscard]] const std::vector<std::size_t>& noisy_lines() const { return noisy_; }
  // Addresses with only invalid responses, without those with a valid one to the second request.
  [[nodiscard]] std::vector<ScanBroken> broken() const;
  // At least one request received only its own echo.
  [[nodiscard]] bool echoed() const { return echoed_; }
  // A quick search ended, and no line had bytes other than an echo.
  [[nodiscard]] bool silent() const { return quick_ && over() && !heard_any_; }

 private:
  void advance();
  void end_line();
  void next_line();
  void probed(const ScanResponse& response);
  void search_or_probe_next();
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
  bool noise_ = false;     // in this search of the line
  bool repeated_ = false;  // this is its second search
  bool echoed_ = false;
  bool quick_ = false;       // lines have probes
  bool probing_ = false;     // false: searching
  bool heard_once_ = false;  // on the probed line
  bool heard_any_ = false;
};

}  // namespace fieldcast::cli
