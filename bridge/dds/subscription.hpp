// One reader of a keyed topic whose samples are converted and handed on as plain structs. Calls come on DDS threads, one at a
// time.
#pragma once

#include <fastdds/dds/subscriber/SampleInfo.hpp>
#include <functional>
#include <map>
#include <mutex>
#include <utility>

#include "bridge/dds/domain.hpp"

namespace fieldcast {

template <class Generated>
class Subscription : private dds::DataReaderListener {
 public:
  using Topic = typename Generated::type;
  struct Handlers {
    std::function<void(const Topic&)> sample;
    // An instance was disposed, or nobody writes it any more: the topic object with its keys. Null: nobody asks.
    std::function<void(const Topic&)> gone;
    std::function<void()> deadline_missed;
  };

  Subscription(Domain& domain, const char* topic, const dds::DataReaderQos& qos, Handlers handlers)
      : domain_(domain), limit_(static_cast<std::size_t>(qos.resource_limits().max_instances)), handlers_(std::move(handlers)) {
    dds::StatusMask mask = dds::StatusMask::data_available();
    if (handlers_.deadline_missed) mask << dds::StatusMask::requested_deadline_missed();
    reader_ = domain_.reader<Generated>(topic, qos, this, mask);
  }
  ~Subscription() override { domain_.remove(reader_); }
  Subscription(const Subscription&) = delete;
  Subscription& operator=(const Subscription&) = delete;

 private:
  void on_data_available(dds::DataReader* reader) override {
    const std::lock_guard lock(mutex_);
    dds::SampleInfo info;
    while (reader->take_next_sample(&received_, &info) == ReturnCode_t::RETCODE_OK) {
      if (info.valid_data) {
        if (handlers_.gone && known_.size() < limit_) known_.try_emplace(info.instance_handle, received_);
        handlers_.sample(received_);
      } else if (handlers_.gone && info.instance_state != dds::ALIVE_INSTANCE_STATE) {
        // Such a note comes without its keys.
        if (auto node = known_.extract(info.instance_handle)) handlers_.gone(node.mapped());
      }
    }
  }
  void on_requested_deadline_missed(dds::DataReader*, const dds::RequestedDeadlineMissedStatus&) override {
    handlers_.deadline_missed();
  }

  Domain& domain_;
  const std::size_t limit_;
  const Handlers handlers_;
  std::mutex mutex_;  // the library calls on any of the participant's threads
  Topic received_;
  std::map<dds::InstanceHandle_t, Topic> known_;  // only with `gone`; at most limit_
  dds::DataReader* reader_ = nullptr;
};

}  // namespace fieldcast
