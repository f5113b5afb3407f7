// What fieldcast-port says of itself: lines for people, or JSON lines with the same contents.
#pragma once

#include <string>

#include "core/base/time.hpp"

namespace fieldcast::port {

class PortReport {
 public:
  PortReport(bool json, std::string device, std::string link)
      : json_(json), device_(std::move(device)), link_(std::move(link)) {}
  ~PortReport();  // the last lines are written, if somebody reads them
  PortReport(const PortReport&) = delete;
  PortReport& operator=(const PortReport&) = delete;

  void state(const std::string& state, const std::string& text) const;
  void dropped(const std::string& text) const;
  void line(std::uint32_t baud, unsigned stop_bits) const;
  // Totals so far and the rates since the last call; nothing when nothing moved. `last`: always,
  // with the rates of the whole time.
  void traffic(std::uint64_t sent, std::uint64_t received, Instant now, bool last);
  void paired(Instant now) { since_ = at_ = now; }

 private:
  bool json_;
  std::string device_, link_;
  Instant since_{}, at_{};
  std::uint64_t sent_ = 0, received_ = 0;  // at the last call
};

}  // namespace fieldcast::port
