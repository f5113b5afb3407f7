#include "tools/forward/send/late_window.hpp"

#include <gtest/gtest.h>

#include <deque>

namespace fieldcast::forward {
namespace {

using std::chrono::milliseconds;

TEST(LateWindow, OneMessageMayAlwaysBeInFlight) {
  LateWindow window;
  EXPECT_TRUE(window.allows(10 * LateWindow::kMost));
  window.sent(10 * LateWindow::kMost);
  EXPECT_FALSE(window.allows(1));
  window.failed(10 * LateWindow::kMost);
  EXPECT_TRUE(window.allows(1));
}

// A line with a round trip and a bandwidth, on which only late messages are sent. Returns the delay
// of the last one, and the bytes of `seconds`.
struct Line {
  Duration round_trip;
  double bytes_per_second;
  Duration delay{};
  std::size_t bytes = 0;

  void run(LateWindow& window, int seconds) {
    struct Message {
      Instant sent, acknowledged;
    };
    constexpr std::size_t kBytes = 16'000;
    std::deque<Message> in_flight;
    Instant now{}, idle{};
    for (const Instant end = now + std::chrono::seconds{seconds}; now < end;
         now += milliseconds{1}) {
      while (!in_flight.empty() && in_flight.front().acknowledged <= now) {
        delay = now - in_flight.front().sent;
        window.acknowledged(kBytes, delay, now);
        bytes += kBytes;
        in_flight.pop_front();
      }
      while (window.allows(kBytes)) {
        idle = std::max(idle, now) +
               Duration{static_cast<std::int64_t>(1e9 * kBytes / bytes_per_second)};
        in_flight.push_back({now, idle + round_trip});
        window.sent(kBytes);
      }
    }
  }
};

TEST(LateWindow, AFastLineWithALongRoundTripIsFilled) {
  LateWindow window;
  Line line{milliseconds{200}, 10e6};
  line.run(window, 20);
  EXPECT_GT(line.bytes, 20 * 10e6 / 2);
}

TEST(LateWindow, OnASlowLineFewBytesWait) {
  LateWindow window;
  Line line{milliseconds{50}, 250e3};
  line.run(window, 60);
  EXPECT_GT(line.bytes, 60 * 250e3 * 0.9);
  EXPECT_LT(line.delay, milliseconds{900});
}

}  // namespace
}  // namespace fieldcast::forward
