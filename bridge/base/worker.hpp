// A named thread with its own bounded queue: the form of every thread that gets work from others.
//
// The owner must close the worker before it destroys anything that the work uses.
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
  // `work` runs once on the thread and must take from the queue until it is closed. The kernel
  // shows 15 bytes of the name.
  Worker(std::string name, std::size_t limit, std::function<void(BoundedQueue<Item>&)> work)
      : queue_(limit), thread_([this, name = std::move(name), work = std::move(work)] {
          pthread_setname_np(pthread_self(), name.c_str());
          work(queue_);
        }) {}
  ~Worker() { close(); }

  [[nodiscard]] BoundedQueue<Item>& queue() { return queue_; }

  // Closes the queue and waits for the work to end; may be called twice. One thread.
  void close() {
    queue_.close();
    if (thread_.joinable()) thread_.join();
  }

 private:
  BoundedQueue<Item> queue_;
  std::thread thread_;  // last: it uses the members above
};

}  // namespace fieldcast
