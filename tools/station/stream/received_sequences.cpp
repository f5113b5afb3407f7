#include "tools/station/stream/received_sequences.hpp"

#include <algorithm>

namespace fieldcast::web {

bool ReceivedSequences::add(std::uint64_t epoch, std::uint64_t sequence) {
  if (epoch < epoch_) return true;
  if (epoch > epoch_) {
    epoch_ = epoch;
    runs_.clear();
  }
  // The first run that ends at or after the sequence before this one.
  const auto run = std::find_if(runs_.begin(), runs_.end(), [sequence](const Run& each) {
    return each.last >= sequence || each.last + 1 == sequence;
  });
  if (run == runs_.end()) {
    runs_.push_back({sequence, sequence});
  } else if (run->first <= sequence && sequence <= run->last) {
    return false;
  } else if (run->last < sequence) {
    run->last = sequence;
    const auto next = run + 1;
    if (next != runs_.end() && next->first == sequence + 1) {
      run->last = next->last;
      runs_.erase(next);
    }
  } else if (run->first == sequence + 1) {
    run->first = sequence;
  } else {
    runs_.insert(run, {sequence, sequence});
  }
  if (runs_.size() > kMaxRuns) runs_.erase(runs_.begin());
  return true;
}

}  // namespace fieldcast::web
