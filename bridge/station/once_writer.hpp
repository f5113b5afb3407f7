// A writer of messages whose keys never repeat. Each message is an instance that both ends must
// release, or their memory grows without limit.
//
// An instance is unregistered only when the message itself is acknowledged and removed from the
// history. Fast DDS 2.9.1 iterates backwards over acknowledged messages and removes a message
// together with its unregister message, while its iterator points at one of them
// (StatefulWriter::check_acked_status, DataWriterHistory::remove_instance_changes). Later messages
// are then dropped although no reader has them, and the writer and its readers wait for each other
// forever.
#pragma once

#include <algorithm>
#include <cstddef>
#include <deque>
#include <fastdds/dds/publisher/DataWriter.hpp>
#include <mutex>

#include "bridge/dds/topics/topics.hpp"
#include "core/base/time.hpp"

namespace fieldcast {

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

  // Unregisters the instances of written messages if all are acknowledged. Returns false if some
  // remain.
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
