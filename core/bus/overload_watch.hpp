// Whether a bus is overloaded, as told to people: a stretch of the refreshes is told once it has
// lasted, and so is its end. In the first seconds answer times are learned, and plans change often.
//
// Owns what was told last and since when it is otherwise. Owned by the bus engine, on the bus's
// thread. Nothing can fail.
#pragma once

#include <array>
#include <cstdio>
#include <optional>
#include <string>

#include "core/base/time.hpp"
#include "core/bus/event.hpp"

namespace fieldcast {

class OverloadWatch {
 public:
  static constexpr Duration kLasts = std::chrono::seconds{5};
  static constexpr double kStretched = 1.001;  // a factor on refreshes; more is overload

  // `stretch` of the configured refreshes. An overload that they cause gives no notice: whoever
  // loads the configuration is told already.
  explicit OverloadWatch(double stretch) : overloaded_(stretch > kStretched) {}

  // The stretch at present. The notice that is due now, if any.
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
  bool overloaded_;           // as told
  Instant changed_ = kNever;  // it is otherwise since then
};

}  // namespace fieldcast
