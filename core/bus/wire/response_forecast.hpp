// Forecasts when the response to the request on the wire can be complete, so that the shell reads
// it once instead of after each piece. A response that is read late has no exact begin, by which a
// response to another request is recognized (ResponseTime::too_early()). So only a bus that has
// seen nothing but exact responses for a while waits for the whole response. Owned by the bus
// engine, on the bus's thread.
#pragma once

#include <algorithm>
#include <optional>

#include "core/base/time.hpp"
#include "core/bus/wire/exchange_driver.hpp"

namespace fieldcast {

class ResponseForecast {
 public:
  // Exact responses in a row before the first forecast of a whole response.
  static constexpr unsigned kTrusted = 64;
  // One of so many responses is read early, so that response times stay exact.
  static constexpr unsigned kMeasured = 16;
  // An early read precedes the end by this time, as a sleeping thread wakes late on a busy machine,
  // and by kTooEarly characters.
  static constexpr Duration kEarlyWake = std::chrono::milliseconds{2};
  static constexpr double kTooEarly = 3;
  // A whole response is read later than the earliest one by this time at most, so that its last
  // bytes do not wake the thread again.
  static constexpr Duration kLatest = std::chrono::microseconds{150};
  // A shorter response, for example a refusal, is delivered at the latest after this time.
  static constexpr Duration kLongest = std::chrono::milliseconds{50};

  // A response failed, or bytes arrived that belong to no request.
  void doubt() {
    exact_ = 0;
    whole_ = false;
  }
  void ended(const ExchangeDriver& driver, bool done) {
    if (!done || driver.expected() == 0 || driver.received().size() != driver.expected())
      return doubt();
    ++exact_;
  }
  // Call before a request. `owed`: a response to an earlier request may still arrive.
  void begin(bool owed) { whole_ = !owed && exact_ >= kTrusted && exact_ % kMeasured != 0; }
  // The response may be read when it is complete, so bytes that arrived earlier seem to be in time.
  [[nodiscard]] bool waits_for_whole() const { return whole_; }
  // Returns true if bytes behind the response would show that it began before it could: it belongs
  // to another request. A response may also be longer than expected: DF1 doubles a byte 10.
  [[nodiscard]] bool too_early(const ExchangeDriver& driver) const {
    return whole_ && driver.received().size() > driver.expected();
  }

  // Bytes that arrive before this time need no delivery before it; kLongAgo: deliver them as they
  // arrive. `earliest`: see ResponseTime.
  [[nodiscard]] Instant quiet_until(const ExchangeDriver& driver,
                                    std::optional<Duration> earliest) const {
    const bool begun = driver.missing() > 0;
    if (!earliest || driver.expected() == 0 || (!begun && !driver.raw_received().empty()))
      return kLongAgo;
    const LineFormat& line = driver.response_line();
    const Instant end =
        driver.sent_until() + line.characters(static_cast<double>(driver.expected()));
    const Duration late = std::min(kLatest, line.characters(0.2));
    if (begun) {
      const Instant rest = driver.responded() + line.characters(driver.missing());
      const Instant early = rest - line.characters(1) - std::max(kEarlyWake, line.characters(1));
      return whole_ ? std::max(early, std::min(rest, end + *earliest) + late) : early;
    }
    const Instant until =
        whole_ ? end + *earliest + late : end - std::max(kEarlyWake, line.characters(kTooEarly));
    return std::min(until, driver.responded() + kLongest);
  }

 private:
  unsigned exact_ = 0;  // exact responses since the last doubt
  bool whole_ = false;  // the response may be read when it is complete
};

}  // namespace fieldcast
