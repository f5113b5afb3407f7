// Runs an io_context until a condition is true, and records the callbacks of a port.
#pragma once

#include <gtest/gtest.h>

#include <boost/asio/io_context.hpp>
#include <chrono>
#include <functional>
#include <optional>
#include <string>

#include "bridge/port/port.hpp"

namespace fieldcast::test {

class PortProbe : public PortListener {
 public:
  void on_opened() override { ++opened; }
  void on_received(ByteView bytes, Instant arrival) override {
    append(received, bytes);
    arrived = arrival;
    ++deliveries;
    if (on_bytes) on_bytes();
  }
  void on_closed(std::string reason, Cause cause) override {
    closed.push_back(std::move(reason));
    causes.push_back(cause);
  }

  int opened = 0, deliveries = 0;
  Bytes received;
  Instant arrived = kLongAgo;
  std::vector<std::string> closed;
  std::vector<Cause> causes;  // of closed
  std::function<void()> on_bytes;
};

// Returns false after the limit.
[[nodiscard]] inline bool run_until(boost::asio::io_context& io, const std::function<bool()>& done,
                                    std::chrono::milliseconds limit = std::chrono::seconds{5}) {
  const auto deadline = std::chrono::steady_clock::now() + limit;
  while (!done()) {
    const auto left = deadline - std::chrono::steady_clock::now();
    if (left <= left.zero()) return false;
    if (io.stopped()) io.restart();
    io.run_one_for(std::min<std::chrono::nanoseconds>(left, std::chrono::milliseconds{20}));
  }
  return true;
}

}  // namespace fieldcast::test
