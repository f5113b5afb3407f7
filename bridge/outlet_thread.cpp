#include "bridge/outlet_thread.hpp"

#include <pthread.h>

#include <future>
#include <utility>

namespace fieldcast {

OutletThread::OutletThread() : thread_([this] { run(); }) {}

OutletThread::~OutletThread() {
  {
    const std::lock_guard lock(mutex_);
    ending_ = true;
  }
  work_.notify_one();
  thread_.join();
}

void OutletThread::post(std::function<void()> task) {
  {
    std::unique_lock lock(mutex_);
    room_.wait(lock, [this] { return waiting_.size() < kMaxWaiting; });
    waiting_.push_back(std::move(task));
  }
  work_.notify_one();
}

void OutletThread::drain() {
  std::promise<void> reached;
  post([&reached] { reached.set_value(); });
  reached.get_future().wait();
}

void OutletThread::run() {
  pthread_setname_np(pthread_self(), "outlet");
  std::unique_lock lock(mutex_);
  while (true) {
    work_.wait(lock, [this] { return ending_ || !waiting_.empty(); });
    if (waiting_.empty()) return;
    const std::function<void()> task = std::move(waiting_.front());
    waiting_.pop_front();
    lock.unlock();
    room_.notify_one();
    task();
    lock.lock();
  }
}

}  // namespace fieldcast
