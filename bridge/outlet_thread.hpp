// The thread on which results, reports and larger blocks of samples leave for DDS. A DataWriter takes some 10 us for each sample
// and wakes other threads; on the bus's own thread that time would be missing from the silence after an answer, and the next
// request would be late.
//
// Tasks run one after the other, in the order in which they were posted. Any thread may post.
#pragma once

#include <condition_variable>
#include <cstddef>
#include <deque>
#include <functional>
#include <mutex>
#include <thread>

namespace fieldcast {

class OutletThread {
 public:
  // Tasks that may wait. Whoever posts one more waits for room: buses then run no faster than DDS takes their samples.
  static constexpr std::size_t kMaxWaiting = 4096;

  OutletThread();
  ~OutletThread();  // runs what was posted, then ends
  OutletThread(const OutletThread&) = delete;
  OutletThread& operator=(const OutletThread&) = delete;

  void post(std::function<void()> task);
  // Returns when everything posted before has run. Not from a task.
  void drain();

 private:
  void run();

  std::mutex mutex_;
  std::condition_variable work_;
  std::condition_variable room_;
  std::deque<std::function<void()>> waiting_;
  bool ending_ = false;
  std::thread thread_;  // last: it uses what is above
};

}  // namespace fieldcast
