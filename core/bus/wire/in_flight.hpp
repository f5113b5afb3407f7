// How many exchanges may be in flight on a connection: those of the configuration, fewer if the
// device drops requests. Plain value.
#pragma once

#include <algorithm>

#include "core/base/time.hpp"

namespace fieldcast {

class FlightLimit {
 public:
  // Share of the last requests without a response above which fewer are in flight.
  static constexpr double kTooMany = 0.2;
  // Responses after which one more exchange is tried.
  static constexpr unsigned kEnoughResponses = 256;

  explicit FlightLimit(unsigned most) : most_(most), learned_(most) {}

  void opened() { established_ = false; }
  void responded() {
    established_ = true;
    missing_ -= missing_ * kStep;
    if (learned_ == most_ || ++responses_ < kEnoughResponses) return;
    responses_ = 0;
    ++learned_;
  }
  // No response, but one to a request that was in flight with it.
  void missed() {
    missing_ += (1 - missing_) * kStep;
    if (missing_ <= kTooMany) return;
    missing_ = 0;
    responses_ = 0;
    learned_ = std::max(1u, learned_ / 2);
  }

  // The first exchange of a connection is alone, as it may send a greeting.
  [[nodiscard]] unsigned now() const { return established_ ? learned_ : 1; }
  // The response time for a plan that assumes all of the configuration in flight.
  [[nodiscard]] Duration planned(Duration response_time) const {
    return response_time * most_ / learned_;
  }

 private:
  static constexpr double kStep = 1.0 / 16;
  unsigned most_, learned_;
  unsigned responses_ = 0;  // since the last change
  double missing_ = 0;      // share of the last requests without a response
  bool established_ = false;
};

}  // namespace fieldcast
