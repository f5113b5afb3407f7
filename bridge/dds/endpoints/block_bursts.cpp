#include "bridge/dds/endpoints/block_bursts.hpp"

#include <pthread.h>

#include <utility>

namespace fieldcast {

BlockBursts::BlockBursts(std::function<void()> write)
    : write_(std::move(write)), thread_([this] { run(); }) {}

bool BlockBursts::waits(const void* bus, Instant now) {
  const std::lock_guard lock(mutex_);
  return !closed_ && rule_.waits(bus, now);
}

void BlockBursts::expect() {
  const std::lock_guard lock(mutex_);
  expected_ = true;
  if (idle_) changed_.notify_one();
}

void BlockBursts::close() {
  {
    const std::lock_guard lock(mutex_);
    closed_ = true;
  }
  changed_.notify_one();
  if (thread_.joinable()) thread_.join();
}

// While blocks arrive, the thread wakes once for each burst and no bus wakes it.
void BlockBursts::run() {
  pthread_setname_np(pthread_self(), "bursts");
  std::unique_lock lock(mutex_);
  while (!closed_) {
    idle_ = !expected_;
    changed_.wait(lock, [this] { return closed_ || expected_; });
    for (idle_ = false; !closed_;) {
      (void)changed_.wait_for(lock, BurstRule::kWindow, [this] { return closed_; });
      if (!std::exchange(expected_, false)) break;
      lock.unlock();
      write_();
      lock.lock();
    }
  }
}

}  // namespace fieldcast
