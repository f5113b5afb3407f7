#pragma once

#include <gtest/gtest.h>

#include <boost/asio/io_context.hpp>
#include <chrono>

namespace fieldcast::web {

struct IoTest : ::testing::Test {
  // Runs the io context until `condition` is true, for at most 10 s.
  template <class Condition>
  bool run_until(Condition condition) {
    const auto end = std::chrono::steady_clock::now() + std::chrono::seconds{10};
    while (!condition() && std::chrono::steady_clock::now() < end) {
      io.restart();
      io.run_for(std::chrono::milliseconds{5});
    }
    return condition();
  }
  boost::asio::io_context io;
};

}  // namespace fieldcast::web
