// Joins RTPS messages of one sender: the header once, then all submessages. A state that one sets,
// as INFO_DST does, holds for the following ones (RTPS 2.2, 8.3.4). Pure; one owner.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "bridge/dds/library/fastdds.hpp"

namespace fieldcast {

class JoinedMessage {
 public:
  explicit JoinedMessage(std::size_t most_bytes) : most_bytes_(most_bytes) {}

  // Returns false, without a change, if the message does not fit or would change its meaning.
  [[nodiscard]] bool append(std::span<const std::uint8_t> message);

  [[nodiscard]] bool empty() const { return bytes_.empty(); }
  // Valid until the next call.
  [[nodiscard]] std::span<const std::uint8_t> whole();
  void clear();

 private:
  std::size_t most_bytes_;
  std::vector<std::uint8_t> bytes_;
  std::vector<std::uint8_t> tail_;  // the library's statistics submessage, which must be last
  bool directed_ = false;           // an INFO_DST is in force at the end
};

// While an object of this class exists, messages of its thread for the same receivers become one,
// across writers, up to a size limit: a few datagrams instead of one for each sample. Other threads
// send as usual; their heartbeats may name samples that are still kept here, which are sent twice
// at worst. So the object must live only briefly, and the thread must not wait for
// acknowledgements. At most one object per thread at a time.
class JoinedSending {
 public:
  explicit JoinedSending(std::size_t most_bytes);
  ~JoinedSending();  // sends the kept messages
  JoinedSending(const JoinedSending&) = delete;
  JoinedSending& operator=(const JoinedSending&) = delete;

  // Null if this thread sends each message individually.
  static JoinedSending* of_this_thread();

  // Keeps the message, or sends it after the kept ones if it cannot be joined; false if that fails.
  bool send(PassingTransport& transport, const OutgoingMessage& message);

 private:
  struct Kept {
    PassingTransport* transport;
    rtps::SenderResource* below;
    std::vector<rtps::Locator_t> to;
    OutgoingMessage::Deadline deadline;
    JoinedMessage message;
  };
  static void let_go(Kept& kept);

  std::size_t most_bytes_;
  std::vector<Kept> kept_;
  std::vector<rtps::Locator_t> to_;  // of one call, kept for its memory
};

// Builds an unregister message that every vendor can read (RTPS 2.2, 9.6.3.4 and 8.7.4): DATA with
// STATUS_INFO and the serialized key. Fast DDS 2.9.1 sends only a hash of the key, so Cyclone DDS
// prints an error and keeps the instance. Here an ordinary message has the key as its payload, and
// a mark of the same length in its inline QoS, which the transport replaces when it sends the
// message. Pure; any thread.
[[nodiscard]] rtps::SampleIdentity unregister_mark(const rtps::InstanceHandle_t& key);

// Returns true if a whole RTPS message contains a marked DATA.
[[nodiscard]] bool holds_marks(std::span<const std::uint8_t> message);

// Turns every marked DATA into an unregister message: replaces the mark by KEY_HASH (or padding, if
// the message has a KEY_HASH) and STATUS_INFO, and flags the payload as a key. The length and other
// messages are unchanged.
void turn_marks_into_notes(std::span<std::uint8_t> message);

}  // namespace fieldcast
