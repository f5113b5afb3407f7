// The bridges that accept commands for a bus, from fieldcast/Bridge: the one that serves it, or,
// while none does, the members of its standby group. A bridge whose lease has expired accepts none.
// Callbacks run on DDS threads; any thread may call takers().
#pragma once

#include <algorithm>
#include <chrono>
#include <cstddef>
#include <deque>
#include <fastdds/dds/publisher/DataWriter.hpp>
#include <fastdds/dds/subscriber/SampleInfo.hpp>
#include <functional>
#include <map>
#include <mutex>
#include <set>
#include <string>
#include <vector>

#include "bridge/dds/receivers/taker.hpp"
#include "bridge/dds/topics/topics.hpp"
#include "bridge/dds/transport/domain.hpp"
#include "core/base/time.hpp"

namespace fieldcast {

class BusServers : private dds::DataReaderListener {
 public:
  using Participant = rtps::GuidPrefix_t;
  struct Taker {
    Participant participant;
    // First announcement. A bridge that shows no command endpoints some time later is forged.
    std::chrono::steady_clock::time_point since;
  };

  // `changed` is called whenever the result of takers() may have changed. Throws DdsError.
  BusServers(Domain& domain, std::function<void()> changed);
  ~BusServers() override;
  BusServers(const BusServers&) = delete;
  BusServers& operator=(const BusServers&) = delete;

  [[nodiscard]] std::vector<Taker> takers(const std::string& bus) const;

 private:
  using Handle = dds::InstanceHandle_t;
  struct Known {
    std::map<std::string, bool> buses;  // true: it serves the bus
    bool in_group = false;
    std::chrono::steady_clock::time_point since;
  };
  void on_data_available(dds::DataReader* reader) override;
  void on_subscription_matched(dds::DataReader* reader,
                               const dds::SubscriptionMatchedStatus& status) override;
  void on_liveliness_changed(dds::DataReader* reader,
                             const dds::LivelinessChangedStatus& status) override;

  static constexpr std::size_t kMostLost = 256;
  Domain& domain_;
  const std::function<void()> changed_;
  mutable std::mutex mutex_;       // never held while changed_ is called
  std::map<Handle, Known> known_;  // last announcement, by writer
  std::set<Handle> silent_;        // writers whose lease has expired
  LostInstances<Known> lost_{kMostLost};
  dds::DataReader* reader_;
};

// A writer of messages whose keys never repeat: both ends must release each instance, or their
// memory grows without limit. An instance is unregistered only when its message is acknowledged and
// removed: Fast DDS 2.9.1 removes a message together with its unregister message while its iterator
// points at one of them (StatefulWriter::check_acked_status,
// DataWriterHistory::remove_instance_changes). Later messages are then dropped, and the writer and
// its readers wait for each other forever.

// `Message` is a topic type with the keys requester and request_id. Any thread.
template <class Message>
class OnceWriter {
 public:
  // Call it before all other functions. The caller owns the entity, which must outlive this object.
  void attach(dds::DataWriter* entity) { entity_ = entity; }

  // Returns false if too many messages are not acknowledged; see make_room().
  [[nodiscard]] bool write(Message& message) {
    const std::lock_guard lock(mutex_);
    let_go();
    if (written_.size() >= limit_ || !is_taken(entity_->write(&message))) return false;
    written_.emplace_back();
    written_.back().requester(message.requester());
    written_.back().request_id(message.request_id());
    return true;
  }

  // Waits at most `wait` until all readers have acknowledged. A slow reader costs this wait once
  // for each kBatch messages, until kMaxPendingCommands are not acknowledged.
  void make_room(Duration wait) {
    entity_->wait_for_acknowledgments(to_dds(wait));
    const std::lock_guard lock(mutex_);
    if (!let_go()) limit_ = std::min<std::size_t>(limit_ + kBatch, kMaxPendingCommands);
  }

  // Unregisters the instances if all messages are acknowledged. Returns false if some remain.
  bool settle() {
    const std::lock_guard lock(mutex_);
    return let_go();
  }

 private:
  // Numbers that one acknowledgement covers (RTPS 2.2, 9.4.2.6).
  static constexpr std::size_t kBatch = 256;

  bool let_go() {
    if (written_.empty()) return true;
    if (entity_->wait_for_acknowledgments({0, 0}) != ReturnCode_t::RETCODE_OK) return false;
    while (!written_.empty()) {
      const ReturnCode_t done = entity_->unregister_instance(&written_.front(), dds::HANDLE_NIL);
      if (done == ReturnCode_t::RETCODE_TIMEOUT || done == ReturnCode_t::RETCODE_OUT_OF_RESOURCES)
        return false;
      written_.pop_front();
    }
    limit_ = kBatch;
    return true;
  }

  dds::DataWriter* entity_ = nullptr;
  std::mutex mutex_;
  std::deque<Message> written_;  // only the keys, of instances that are not unregistered yet
  std::size_t limit_ = kBatch;
};

}  // namespace fieldcast
