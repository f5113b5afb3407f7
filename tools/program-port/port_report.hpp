// Output of fieldcast-port as text or JSON lines, to standard output and to a log file. The byte
// counters are one redrawn line on a terminal. Main thread; a lost line is not an error.
#pragma once

#include <optional>
#include <string>

#include "bridge/log/log_lines.hpp"
#include "core/base/time.hpp"
#include "tools/progress/progress_line.hpp"

namespace fieldcast::port {

class PortReport {
 public:
  // `port`: name of the local port. `log`: appended to; -1: none.
  PortReport(bool json, std::string device, std::string port, int log = -1);
  ~PortReport();  // writes the last lines if they are read
  PortReport(const PortReport&) = delete;
  PortReport& operator=(const PortReport&) = delete;

  void state(const std::string& state, const std::string& text);
  void dropped(const std::string& text);
  void line(std::uint32_t baud, unsigned stop_bits);
  // Totals and rates since the last call; nothing without new bytes. `last`: always, with the rates
  // of the whole time.
  void traffic(std::uint64_t sent, std::uint64_t received, Instant now, bool last);
  // Redraws the terminal's line, if any; call it often. `waiting`: bytes for the device not sent
  // yet.
  void show_traffic(std::uint64_t sent, std::uint64_t received, std::uint64_t waiting, Instant now);
  void show_last_bytes(double share);
  // Counts from zero again.
  void paired(Instant now);
  // A line about this run, for the log file alone.
  void note(const std::string& text);

 private:
  void print(const std::string& line);

  bool json_;
  bool redrawn_;  // terminal with a progress line
  std::string device_, port_;
  std::optional<LineWriter> log_;
  ProgressLine progress_;
  Instant since_{}, at_{};
  std::uint64_t sent_ = 0, received_ = 0;  // at the last call
  Instant shown_at_{};
  std::uint64_t shown_sent_ = 0, shown_received_ = 0;  // on the terminal's line
};

}  // namespace fieldcast::port
