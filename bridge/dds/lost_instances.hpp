// What a reader had of writers that were lost. Fast DDS 2.9.1 gives each message of a writer once:
// a writer that was lost for longer than its participant's lease, and returns, is asked only for
// what it wrote since (RTPSReader::remove_persistence_guid keeps the number of the last message). A
// reader that forgets the instances of a lost writer keeps them here, and takes them back when the
// writer returns.
//
// A writer that ended never returns: those that were lost first make room. No thread and no lock of
// its own.
#pragma once

#include <deque>
#include <map>
#include <utility>

#include "bridge/dds/fastdds.hpp"

namespace fieldcast {

template <class Kept>
class LostInstances {
 public:
  using Handle = dds::InstanceHandle_t;

  // `most`: instances of all writers together.
  explicit LostInstances(std::size_t most) : most_(most) {}

  void keep(const Handle& writer, const Handle& instance, Kept kept) {
    const auto [of, is_new] = writers_.try_emplace(writer);
    if (is_new) order_.push_back(writer);
    size_ += of->second.insert_or_assign(instance, std::move(kept)).second;
    while (size_ > most_) drop(order_.front());
  }
  // By instance, and no longer here.
  [[nodiscard]] std::map<Handle, Kept> take(const Handle& writer) {
    const auto of = writers_.find(writer);
    if (of == writers_.end()) return {};
    auto kept = std::move(of->second);
    size_ -= kept.size();
    of->second.clear();
    drop(writer);
    return kept;
  }
  // The library gave a later message of this instance, or the note of its end.
  void forget(const Handle& writer, const Handle& instance) {
    const auto of = writers_.find(writer);
    if (of != writers_.end()) size_ -= of->second.erase(instance);
  }
  [[nodiscard]] std::size_t size() const { return size_; }

 private:
  void drop(const Handle writer) {  // a copy: it may stand in order_
    const auto of = writers_.find(writer);
    size_ -= of->second.size();
    writers_.erase(of);
    std::erase(order_, writer);
  }

  const std::size_t most_;
  std::size_t size_ = 0;
  std::map<Handle, std::map<Handle, Kept>> writers_;
  std::deque<Handle> order_;  // of writers_: the one that was lost first stands first
};

}  // namespace fieldcast
