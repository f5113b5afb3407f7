// Converts samples of a keyed topic to plain structs for handlers, one at a time, on DDS threads.
#pragma once

#include <fastdds/dds/subscriber/SampleInfo.hpp>
#include <functional>
#include <map>
#include <mutex>
#include <utility>

#include "bridge/dds/receivers/taker.hpp"
#include "bridge/dds/transport/domain.hpp"

namespace fieldcast {

template <class Generated, class Type = TopicType<Generated>>
class Subscription : private dds::DataReaderListener {
 public:
  using Message = typename Type::Message;
  struct Handlers {
    std::function<void(const Message&)> sample;
    // Called with the last message of an instance that was disposed or has no writer any more. May
    // be null. When a lost writer returns, `sample` is called again for its instances.
    std::function<void(const Message&)> gone;
    // Called with the keys of an instance of a live writer whose reader deadline has passed without
    // a sample. May be null.
    std::function<void(const Message&)> deadline_missed;
  };

  Subscription(Domain& domain, const fieldcast::Topic<Generated>& topic, Handlers handlers)
      : Subscription(domain, topic, reader_qos(topic), std::move(handlers)) {}
  Subscription(Domain& domain, const fieldcast::Topic<Generated>& topic,
               const dds::DataReaderQos& qos, Handlers handlers)
      : domain_(domain),
        limit_(static_cast<std::size_t>(qos.resource_limits().max_instances)),
        handlers_(std::move(handlers)),
        lost_(limit_) {
    dds::StatusMask mask = dds::StatusMask::data_available();
    if (remembers()) mask << dds::StatusMask::subscription_matched();
    if (handlers_.deadline_missed) mask << dds::StatusMask::requested_deadline_missed();
    reader_ = domain_.template reader<Generated, Type>(topic, qos, this, mask);
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
        if (remembers()) remember(info.instance_handle, info.publication_handle);
        handlers_.sample(received_);
      } else if (info.instance_state != dds::ALIVE_INSTANCE_STATE) {
        lost_.forget(info.publication_handle, info.instance_handle);
        // Such a message arrives without its keys.
        if (const auto node = known_.extract(info.instance_handle)) end(node.key(), node.mapped());
      }
    }
  }
  // A writer that crashes or leaves changes its instances without a message of the library.
  void on_subscription_matched(dds::DataReader*,
                               const dds::SubscriptionMatchedStatus& status) override {
    const std::lock_guard lock(mutex_);
    if (status.current_count_change > 0) return_of(status.last_publication_handle);
    if (status.current_count_change >= 0) return;
    for (auto known = known_.begin(); known != known_.end();) {
      if (known->second.writer != status.last_publication_handle) {
        ++known;
        continue;
      }
      const auto node = known_.extract(known++);
      end(node.key(), node.mapped());
      lost_.keep(node.mapped().writer, node.key(), std::move(node.mapped().last));
    }
  }
  // Fast DDS 2.9.1 continues to count for an instance whose last writer has left. Such misses are
  // not reported. The reader's lock is held here, so mutex_ must not be locked.
  void on_requested_deadline_missed(dds::DataReader*,
                                    const dds::RequestedDeadlineMissedStatus& status) override {
    Message late;
    {
      const std::lock_guard lock(promised_mutex_);
      const auto found = promised_.find(status.last_instance_handle);
      if (found == promised_.end()) return;
      late = found->second;
    }
    handlers_.deadline_missed(late);
  }

  struct Known {
    Message last;                  // for its keys, and if its writer returns
    dds::InstanceHandle_t writer;  // of the latest sample
  };
  [[nodiscard]] bool remembers() const {
    return handlers_.gone != nullptr || handlers_.deadline_missed != nullptr;
  }
  // REQUIRES for all: mutex_ held.
  void remember(const dds::InstanceHandle_t& instance, const dds::InstanceHandle_t& writer) {
    lost_.forget(writer, instance);
    const auto known = known_.find(instance);
    if (known != known_.end()) {
      known->second.last = received_;
      known->second.writer = writer;
    } else if (known_.size() < limit_) {
      known_.emplace(instance, Known{received_, writer});
      if (handlers_.deadline_missed == nullptr) return;
      const std::lock_guard lock(promised_mutex_);
      promised_.emplace(instance, received_);
    }
  }
  // Restores the instances that it had written; its later messages are still to arrive.
  void return_of(const dds::InstanceHandle_t& writer) {
    for (auto& [instance, last] : lost_.take(writer)) {
      if (known_.contains(instance)) continue;  // another writer owns it now
      received_ = std::move(last);
      remember(instance, writer);
      handlers_.sample(received_);
    }
  }
  void end(const dds::InstanceHandle_t& instance, const Known& known) {
    if (handlers_.deadline_missed) {
      const std::lock_guard lock(promised_mutex_);
      promised_.erase(instance);
    }
    if (handlers_.gone) handlers_.gone(known.last);
  }

  Domain& domain_;
  const std::size_t limit_;
  const Handlers handlers_;
  std::mutex mutex_;  // the library calls on any thread of the participant
  Message received_;
  std::map<dds::InstanceHandle_t, Known> known_;  // if remembers(); at most limit_
  LostInstances<Message> lost_;
  std::mutex promised_mutex_;  // lock order: after mutex_ and the reader's lock
  // Copy of known_ for missed deadlines; only used with `deadline_missed`.
  std::map<dds::InstanceHandle_t, Message> promised_;
  dds::DataReader* reader_ = nullptr;
};

}  // namespace fieldcast
