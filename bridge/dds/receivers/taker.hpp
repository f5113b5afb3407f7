// Passes each message with data of a reader to a callback, on threads of the library.
#pragma once

#include <deque>
#include <fastdds/dds/subscriber/DataReader.hpp>
#include <fastdds/dds/subscriber/DataReaderListener.hpp>
#include <fastdds/dds/subscriber/SampleInfo.hpp>
#include <functional>
#include <map>
#include <utility>

#include "bridge/dds/library/fastdds.hpp"

namespace fieldcast {

template <class Message>
class Taker : public dds::DataReaderListener {
 public:
  using Take = std::function<void(const Message&, const dds::SampleInfo&)>;
  explicit Taker(Take take) : take_(std::move(take)) {}

 private:
  void on_data_available(dds::DataReader* reader) override {
    Message message;
    dds::SampleInfo info;
    while (reader->take_next_sample(&message, &info) == ReturnCode_t::RETCODE_OK) {
      if (info.valid_data) take_(message, info);
    }
  }
  const Take take_;
};

// Samples of writers that were lost. Fast DDS 2.9.1 delivers each message of a writer once: from a
// lost writer that returns, it requests only later messages (RTPSReader::remove_persistence_guid).
// So a reader stores its instances here and restores them. A writer that has ended never returns:
// at the limit, the writers lost first are dropped. Not thread-safe.
template <class Kept>
class LostInstances {
 public:
  using Handle = dds::InstanceHandle_t;

  // `most` bounds the instances of all writers together.
  explicit LostInstances(std::size_t most) : most_(most) {}

  void keep(const Handle& writer, const Handle& instance, Kept kept) {
    const auto [of, is_new] = writers_.try_emplace(writer);
    if (is_new) order_.push_back(writer);
    size_ += of->second.insert_or_assign(instance, std::move(kept)).second;
    while (size_ > most_) drop(order_.front());
  }
  // Removes and returns the instances of a writer.
  [[nodiscard]] std::map<Handle, Kept> take(const Handle& writer) {
    const auto of = writers_.find(writer);
    if (of == writers_.end()) return {};
    auto kept = std::move(of->second);
    size_ -= kept.size();
    of->second.clear();
    drop(writer);
    return kept;
  }
  // Call it when the library delivers a later message of this instance, or its end.
  void forget(const Handle& writer, const Handle& instance) {
    const auto of = writers_.find(writer);
    if (of != writers_.end()) size_ -= of->second.erase(instance);
  }
  [[nodiscard]] std::size_t size() const { return size_; }

 private:
  void drop(const Handle writer) {  // a copy: the argument may be an element of order_
    const auto of = writers_.find(writer);
    size_ -= of->second.size();
    writers_.erase(of);
    std::erase(order_, writer);
  }

  const std::size_t most_;
  std::size_t size_ = 0;
  std::map<Handle, std::map<Handle, Kept>> writers_;
  std::deque<Handle> order_;  // of writers_: the writer lost first is at the front
};

}  // namespace fieldcast
