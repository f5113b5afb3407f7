#include "bridge/publish/publisher_thread.hpp"

#include <gtest/gtest.h>

#include <future>

#include "bridge/base/clock.hpp"

namespace fieldcast {
namespace {

struct Held {
  explicit Held(PublisherThread& thread) {
    thread.post([future = go.get_future().share()] { future.wait(); });
  }
  std::promise<void> go;
};

TEST(PublisherThread, RunsTasksInTheirOrder) {
  PublisherThread thread;
  std::string order;
  for (const char c : std::string("abc")) thread.post([&order, c] { order += c; });
  thread.drain();
  EXPECT_EQ(order, "abc");
}

TEST(PublisherThread, AStopDropsTheSamplesThatWaitAndNothingElse) {
  PublisherThread thread;
  Held held(thread);
  int samples = 0, results = 0;
  for (int i = 0; i < 100; ++i) {
    thread.post([&] { ++samples; }, PublisherThread::Late::kDrop);
    thread.post([&] { ++results; });
  }
  thread.drop_from(steady_now());
  held.go.set_value();
  thread.drain();
  EXPECT_EQ(samples, 0);
  EXPECT_EQ(results, 100);
  thread.drop_from(kNever);
  thread.post([&] { ++samples; }, PublisherThread::Late::kDrop);
  thread.drain();
  EXPECT_EQ(samples, 1);
}

}  // namespace
}  // namespace fieldcast
