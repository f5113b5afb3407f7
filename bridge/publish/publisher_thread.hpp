// Thread that writes results, reports and larger blocks of samples to DDS. A DataWriter needs some
// 10 us per sample and wakes other threads. On the bus's thread, this time would exceed the silence
// after a response and delay the next request.
//
// Tasks run one after another, in the order of post(). Any thread may post.
#pragma once

#include <atomic>
#include <cstddef>
#include <functional>

#include "bridge/base/worker.hpp"
#include "core/base/time.hpp"

namespace fieldcast {

class PublisherThread {
 public:
  // Limit of waiting tasks. post() waits while it is reached: buses then run no faster than DDS.
  static constexpr std::size_t kMaxWaiting = 4096;

  PublisherThread();
  ~PublisherThread();  // runs the posted tasks, then ends
  PublisherThread(const PublisherThread&) = delete;
  PublisherThread& operator=(const PublisherThread&) = delete;

  enum class Late { kRun, kDrop };  // whether a task is dropped after drop_from()
  void post(std::function<void()> task, Late late = Late::kRun);

  // From `at` on, tasks with kDrop are dropped, also waiting ones. A bridge that stops then does
  // not publish samples whose instances it disposes next. kNever: drops none.
  void drop_from(Instant at) { drop_from_ = at; }

  // Returns when all earlier tasks have run. Must not be called in a task.
  void drain();

 private:
  struct Task {
    std::function<void()> run;
    Late late;
  };
  void run(BoundedQueue<Task>& queue);

  std::atomic<Instant> drop_from_{kNever};
  Worker<Task> worker_;  // last: it uses the members above
};

}  // namespace fieldcast
