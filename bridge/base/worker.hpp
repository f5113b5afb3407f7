// A thread with a name and a bounded queue of its own: the form of every thread that takes work
// from others.
//
// The work runs on the worker's thread. The owner closes the worker before what the work uses goes.
#pragma once

#include <pthread.h>

#include <functional>
#include <string>
#include <thread>

#include "bridge/base/bounded_queue.hpp"

namespace fieldcast {

template <typename Item>
class Worker {
 public:
  // `work` runs once on the thread and takes from the queue until that is closed. The kernel shows
  // 15 bytes of the name.
  Worker(std::string name, std::size_t limit, std::function<void(BoundedQueue<Item>&)> work)
      : queue_(limit), thread_([this, name = std::move(name), work = std::move(work)] {
          pthread_setname_np(pthread_self(), name.c_str());
          work(queue_);
        }) {}
  ~Worker() { close(); }

  [[nodiscard]] BoundedQueue<Item>& queue() { return queue_; }

  // Closes the queue and waits for the end of the work; a second call has no effect. One thread.
  void close() {
    queue_.close();
    if (thread_.joinable()) thread_.join();
  }

 private:
  BoundedQueue<Item> queue_;
  std::thread thread_;  // last: it uses what is above
};

}  // namespace fieldcast
