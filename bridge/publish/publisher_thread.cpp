#include "bridge/publish/publisher_thread.hpp"

#include <future>
#include <utility>

#include "bridge/base/clock.hpp"

namespace fieldcast {

PublisherThread::PublisherThread()
    : worker_("publisher", kMaxWaiting, [this](BoundedQueue<Task>& queue) { run(queue); }) {}

PublisherThread::~PublisherThread() { worker_.close(); }

void PublisherThread::post(std::function<void()> task, Late late) {
  worker_.queue().put({std::move(task), late});
}

void PublisherThread::drain() {
  std::promise<void> reached;
  post([&reached] { reached.set_value(); });
  reached.get_future().wait();
}

void PublisherThread::run(BoundedQueue<Task>& queue) {
  while (const auto task = queue.take()) {
    if (task->late == Late::kRun || steady_now() < drop_from_.load()) task->run();
  }
}

}  // namespace fieldcast
