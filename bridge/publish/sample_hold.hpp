// Samples of a bridge of a standby group that may not leave now: while nobody knows who is master,
// while another master has the wire, and after a takeover until a good value shows that the wire is
// ours. The last one of each channel leaves afterwards: the engine believes that it was published,
// and would not say again that a channel is no longer good.
//
// Pure; on the bus's thread, but for prove_until(). Nothing can fail.
#pragma once

#include <algorithm>
#include <atomic>
#include <map>
#include <utility>
#include <vector>

#include "core/base/time.hpp"
#include "core/model/sample.hpp"

namespace fieldcast {

class SampleHold {
 public:
  // Until then, or the first good value that is acquired after `now`, bad ones stay here. Any
  // thread.
  void prove_until(Instant limit, Instant now) {
    proof_from_ = now;
    prove_until_ = limit;
  }
  // Another master of the group has the wire, and publishes what it reads there.
  void foreign_master(Instant now) {
    proof_from_ = now;
    foreign_ = true;
  }

  // What leaves now of these samples and of those that stayed here. `serves`: this bridge is
  // master. Also to be called without samples now and then.
  [[nodiscard]] std::vector<Sample> pass(std::vector<Sample> samples, bool serves, Instant now) {
    const bool proof =
        std::ranges::any_of(samples, [from = proof_from_.load()](const Sample& each) {
          return each.quality == Quality::kGood &&
                 each.acquired > from;  // not one that is told again
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
  bool foreign_ = false;  // no good value since it was heard
  std::map<ChannelIndex, Sample> held_;
};

}  // namespace fieldcast
