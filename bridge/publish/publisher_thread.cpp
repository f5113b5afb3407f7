#include "bridge/publish/publisher_thread.hpp"

#include <pthread.h>

#include <future>
#include <utility>

#include "bridge/bus/clock.hpp"

namespace fieldcast {

PublisherThread::PublisherThread() : thread_([this] { run(); }) {}

PublisherThread::~PublisherThread() {
  {
    const std::lock_guard lock(mutex_);
    ending_ = true;
  }
  work_.notify_one();
  thread_.join();
}

void PublisherThread::post(std::function<void()> task, Late late) {
  {
    std::unique_lock lock(mutex_);
    room_.wait(lock, [this] { return waiting_.size() < kMaxWaiting; });
    waiting_.push_back({std::move(task), late});
  }
  work_.notify_one();
}

void PublisherThread::drain() {
  std::promise<void> reached;
  post([&reached] { reached.set_value(); });
  reached.get_future().wait();
}

void PublisherThread::run() {
  pthread_setname_np(pthread_self(), "sink");
  std::unique_lock lock(mutex_);
  while (true) {
    work_.wait(lock, [this] { return ending_ || !waiting_.empty(); });
    if (waiting_.empty()) return;
    const Task task = std::move(waiting_.front());
    waiting_.pop_front();
    lock.unlock();
    room_.notify_one();
    if (task.late == Late::kRun || steady_now() < drop_from_.load()) task.run();
    lock.lock();
  }
}

}  // namespace fieldcast
