// What fieldcast-port says of itself: lines for people, or JSON lines with the same contents. At a
// terminal the bytes that pass are one line that is redrawn. Thread of main; nothing fails.
#pragma once

#include <string>

#include "core/base/time.hpp"
#include "tools/progress/progress_line.hpp"

namespace fieldcast::port {

class PortReport {
 public:
  PortReport(bool json, std::string device, std::string link);
  ~PortReport();  // the last lines are written, if somebody reads them
  PortReport(const PortReport&) = delete;
  PortReport& operator=(const PortReport&) = delete;

  void state(const std::string& state, const std::string& text);
  void dropped(const std::string& text);
  void line(std::uint32_t baud, unsigned stop_bits);
  // Totals so far and the rates since the last call; nothing when nothing moved. `last`: always,
  // with the rates of the whole time.
  void traffic(std::uint64_t sent, std::uint64_t received, Instant now, bool last);
  // The same on the terminal's line, where there is one; to be called often. `waiting`: bytes for
  // the device that have not left this machine.
  void show_traffic(std::uint64_t sent, std::uint64_t received, std::uint64_t waiting, Instant now);
  // Behind the end, while the last bytes leave: `share` of them has.
  void show_last_bytes(double share);
  void paired(Instant now) { since_ = at_ = shown_at_ = now; }

 private:
  void print(const std::string& line);

  bool json_;
  bool redrawn_;  // a terminal has the lines and the progress
  std::string device_, link_;
  ProgressLine progress_;
  Instant since_{}, at_{};
  std::uint64_t sent_ = 0, received_ = 0;  // at the last call
  Instant shown_at_{};
  std::uint64_t shown_sent_ = 0, shown_received_ = 0;  // on the terminal's line
};

}  // namespace fieldcast::port
