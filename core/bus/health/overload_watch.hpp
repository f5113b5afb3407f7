// Detects overload of a bus for notices: a stretch of the refreshes, or its end, is reported once
// it lasted for kLasts, as plans change often in the first seconds. On the bus's thread.
#pragma once

#include <array>
#include <cstdio>
#include <optional>
#include <string>

#include "core/base/time.hpp"
#include "core/bus/setup/event.hpp"

namespace fieldcast {

class OverloadWatch {
 public:
  static constexpr Duration kLasts = std::chrono::seconds{5};
  static constexpr double kStretched = 1.001;  // factor on refreshes; more is overload

  // `stretch`: of the configured refreshes. The loader already reports such an overload.
  explicit OverloadWatch(double stretch) : overloaded_(stretch > kStretched) {}

  [[nodiscard]] std::optional<Notice> update(double stretch, Instant now) {
    if ((stretch > kStretched) == overloaded_) {
      changed_ = kNever;
      return std::nullopt;
    }
    if (changed_ == kNever) changed_ = now;
    if (now - changed_ < kLasts) return std::nullopt;
    overloaded_ = !overloaded_;
    if (!overloaded_)
      return Notice{Notice::Kind::kOverloadEnded, {}, Cause::kNone, "every refresh is kept again"};
    std::array<char, 32> times{};
    std::snprintf(times.data(), times.size(), "%.2f", stretch);
    return Notice{Notice::Kind::kOverload,
                  {},
                  Cause::kNone,
                  "more is wanted than the wire carries: refreshes are now up to " +
                      std::string(times.data()) + " times as long"};
  }

 private:
  bool overloaded_;           // as last reported
  Instant changed_ = kNever;  // start of a different state
};

}  // namespace fieldcast
