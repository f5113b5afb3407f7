// A writer of messages whose keys never come again: each is an instance that both ends have to
// forget, or their memory grows for ever.
//
// The note that an instance is let go leaves only when the message itself is acknowledged and gone
// from the history. Fast DDS 2.9.1 walks backwards over what was acknowledged and takes out a
// message together with its note, while its iterator points at one of them
// (StatefulWriter::check_acked_status, DataWriterHistory::remove_instance_changes): what comes
// after is then dropped though nobody has it, and the writer and its readers wait for each other
// for ever.
#pragma once

#include <algorithm>
#include <cstddef>
#include <deque>
#include <fastdds/dds/publisher/DataWriter.hpp>
#include <mutex>

#include "bridge/dds/topics/topics.hpp"
#include "core/base/time.hpp"

namespace fieldcast {

// Message: a topic type with the keys requester and request_id. Any thread.
template <class Message>
class OnceWriter {
 public:
  // Before any other call. The caller owns the entity, which outlives this.
  void attach(dds::DataWriter* entity) { entity_ = entity; }

  // False: too many are not acknowledged, see make_room().
  [[nodiscard]] bool write(Message& message) {
    const std::lock_guard lock(mutex_);
    let_go();
    if (written_.size() >= limit_ || !is_taken(entity_->write(&message))) return false;
    written_.emplace_back();
    written_.back().requester(message.requester());
    written_.back().request_id(message.request_id());
    return true;
  }

  // Waits at most `wait` until all readers have what was written. A reader that stays behind costs
  // this wait once for each kBatch messages, until kMaxPendingCommands are not acknowledged.
  void make_room(Duration wait) {
    entity_->wait_for_acknowledgments(to_dds(wait));
    const std::lock_guard lock(mutex_);
    if (!let_go()) limit_ = std::min<std::size_t>(limit_ + kBatch, kMaxPendingCommands);
  }

  // Lets go of the instances of what was written, if all of it is acknowledged. False: some are
  // left.
  bool settle() {
    const std::lock_guard lock(mutex_);
    return let_go();
  }

 private:
  // One acknowledgement tells of so many (RTPS 2.2, 9.4.2.6).
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
  std::deque<Message> written_;  // the keys alone, of instances that are still to be let go
  std::size_t limit_ = kBatch;   // of written_
};

}  // namespace fieldcast
