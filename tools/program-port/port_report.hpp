// Output of fieldcast-port as text or JSON lines. On a terminal the byte counters are one redrawn
// line. Main thread; nothing fails.
#pragma once

#include <string>

#include "core/base/time.hpp"
#include "tools/progress/progress_line.hpp"

namespace fieldcast::port {

class PortReport {
 public:
  PortReport(bool json, std::string device, std::string link);
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
  void paired(Instant now) { since_ = at_ = shown_at_ = now; }

 private:
  void print(const std::string& line);

  bool json_;
  bool redrawn_;  // terminal with a progress line
  std::string device_, link_;
  ProgressLine progress_;
  Instant since_{}, at_{};
  std::uint64_t sent_ = 0, received_ = 0;  // at the last call
  Instant shown_at_{};
  std::uint64_t shown_sent_ = 0, shown_received_ = 0;  // on the terminal's line
};

}  // namespace fieldcast::port
