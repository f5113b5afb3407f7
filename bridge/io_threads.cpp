#include "bridge/io_threads.hpp"

#include <pthread.h>
#include <sys/prctl.h>

#include <algorithm>
#include <boost/asio/executor_work_guard.hpp>
#include <boost/asio/io_context.hpp>
#include <string>

#include "bridge/check.hpp"

namespace fieldcast {
namespace {

// The kernel may delay a timer by this much to save wake-ups: 50 us by default, too much for silences of 1.75 ms.
constexpr unsigned long kTimerSlackNanoseconds = 1000;

}  // namespace

struct IoThreads::Worker {
  boost::asio::io_context context{1};  // run by one thread: Asio's own locks are never contended
  boost::asio::executor_work_guard<boost::asio::io_context::executor_type> work{context.get_executor()};
  std::thread thread;
};

IoThreads::IoThreads(std::size_t count) {
  FIELDCAST_CHECK(count >= 1);
  for (std::size_t i = 0; i < count; ++i) {
    Worker& worker = *workers_.emplace_back(std::make_unique<Worker>());
    worker.thread = std::thread([&worker, name = "io-" + std::to_string(i)] {
      pthread_setname_np(pthread_self(), name.c_str());
      prctl(PR_SET_TIMERSLACK, kTimerSlackNanoseconds);
      worker.context.run();
    });
  }
}

IoThreads::~IoThreads() { stop(); }

std::size_t IoThreads::default_count() { return std::clamp<std::size_t>(std::thread::hardware_concurrency(), 1, 2); }

boost::asio::io_context& IoThreads::next() { return workers_[turn_++ % workers_.size()]->context; }

void IoThreads::stop() {
  for (auto& worker : workers_) worker->context.stop();
  for (auto& worker : workers_) {
    if (worker->thread.joinable()) worker->thread.join();
  }
}

}  // namespace fieldcast
