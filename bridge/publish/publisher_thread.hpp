// Thread that writes results, reports and larger blocks of samples to DDS: a DataWriter needs some
// 10 us per sample, more than the silence after a response allows. Tasks run in the order of
// post(). Any thread may post.
#pragma once

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <functional>
#include <map>
#include <utility>
#include <vector>

#include "bridge/base/worker.hpp"
#include "core/base/time.hpp"
#include "core/model/sample.hpp"

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

// Holds samples that must not be published now: while the master is unknown, while another master
// uses the wire, and after a takeover until a good value proves that this bridge has the wire.
// Afterwards the last sample of each channel is published, as the engine treats held samples as
// published. Pure; on the bus's thread, except prove_until().
class SampleHold {
 public:
  // Holds samples until `limit` or the first good value acquired after `now`. Any thread.
  void prove_until(Instant limit, Instant now) {
    proof_from_ = now;
    prove_until_ = limit;
  }
  // Another master of the group uses the wire and publishes its values.
  void foreign_master(Instant now) {
    proof_from_ = now;
    foreign_ = true;
  }

  // Returns new and held samples to publish. `serves`: this bridge is master. Call periodically.
  [[nodiscard]] std::vector<Sample> pass(std::vector<Sample> samples, bool serves, Instant now) {
    const bool proof =
        std::ranges::any_of(samples, [from = proof_from_.load()](const Sample& each) {
          return each.quality == Quality::kGood && each.acquired > from;  // not a repeated one
        });
    if (serves && proof) {
      foreign_ = false;
      prove_until_ = kLongAgo;
    }
    if (!serves || foreign_ || now < prove_until_.load()) {
      for (Sample& sample : samples) {
        const ChannelIndex channel = sample.channel;
        held_.insert_or_assign(channel, std::move(sample));
      }
      return {};
    }
    if (held_.empty()) return samples;
    for (const Sample& sample : samples) held_.erase(sample.channel);
    std::vector<Sample> all;
    for (auto& [channel, sample] : std::exchange(held_, {})) all.push_back(std::move(sample));
    std::ranges::move(samples, std::back_inserter(all));
    return all;
  }

 private:
  std::atomic<Instant> prove_until_{kLongAgo}, proof_from_{kLongAgo};
  bool foreign_ = false;  // no good value since foreign_master()
  std::map<ChannelIndex, Sample> held_;
};

}  // namespace fieldcast
