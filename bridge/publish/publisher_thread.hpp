// The thread on which results, reports and larger blocks of samples leave for DDS. A DataWriter
// takes some 10 us for each sample and wakes other threads; on the bus's own thread that time would
// be missing from the silence after an answer, and the next request would be late.
//
// Tasks run one after the other, in the order in which they were posted. Any thread may post.
#pragma once

#include <atomic>
#include <cstddef>
#include <functional>

#include "bridge/base/worker.hpp"
#include "core/base/time.hpp"

namespace fieldcast {

class PublisherThread {
 public:
  // Tasks that may wait. Whoever posts one more waits for space: buses then run no faster than DDS
  // takes their samples.
  static constexpr std::size_t kMaxWaiting = 4096;

  PublisherThread();
  ~PublisherThread();  // runs what was posted, then ends
  PublisherThread(const PublisherThread&) = delete;
  PublisherThread& operator=(const PublisherThread&) = delete;

  enum class Late { kRun, kDrop };  // what becomes of a task after the instant of drop_from()
  void post(std::function<void()> task, Late late = Late::kRun);

  // From that instant on tasks with kDrop are dropped, those that wait too: a bridge that stops
  // does not write the samples of a long queue only to dispose of their instances then. kNever:
  // nothing is dropped.
  void drop_from(Instant at) { drop_from_ = at; }

  // Returns when everything posted before has run. Not from a task.
  void drain();

 private:
  struct Task {
    std::function<void()> run;
    Late late;
  };
  void run(BoundedQueue<Task>& queue);

  std::atomic<Instant> drop_from_{kNever};
  Worker<Task> worker_;  // last: it uses what is above
};

}  // namespace fieldcast
