// While an object of this class exists, the messages that its thread sends are joined: messages for
// the same receivers become one, across writers, up to a size limit. A series of single samples is
// then sent as a few datagrams instead of one for each sample.
//
// Other threads send as usual. Their heartbeats may name samples that are still kept here, which
// are sent twice at worst. So the object must live only briefly, and the thread must not wait for
// acknowledgements meanwhile. At most one object for each thread at a time.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "bridge/dds/filter/joined_message.hpp"
#include "bridge/dds/library/fastdds.hpp"

namespace fieldcast {

class JoinedSending {
 public:
  explicit JoinedSending(std::size_t most_bytes);
  ~JoinedSending();  // sends the kept messages
  JoinedSending(const JoinedSending&) = delete;
  JoinedSending& operator=(const JoinedSending&) = delete;

  // Null if this thread sends each message individually.
  static JoinedSending* of_this_thread();

  // Keeps the message. A message that cannot be joined is sent immediately, after the kept messages
  // for the same receivers. Returns false if that fails.
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

}  // namespace fieldcast
