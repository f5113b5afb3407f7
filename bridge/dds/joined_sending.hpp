// While one lives, what its thread sends leaves together: messages for the same receivers become
// one, across writers, up to a bound. A block of samples one by one is then some datagrams instead
// of one for each sample.
//
// Other threads send as they always do; their heartbeats may name samples that are still kept
// here, which at worst are sent twice. So it must live shortly, and nothing may wait for
// acknowledgements meanwhile. One for each thread at a time.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "bridge/dds/fastdds.hpp"
#include "bridge/dds/joined_message.hpp"

namespace fieldcast {

class JoinedSending {
 public:
  explicit JoinedSending(std::size_t most_bytes);
  ~JoinedSending();  // what is kept leaves
  JoinedSending(const JoinedSending&) = delete;
  JoinedSending& operator=(const JoinedSending&) = delete;

  // Null: this thread sends each message by itself.
  static JoinedSending* of_this_thread();

  // Keeps the message; one that cannot be joined leaves at once, behind what is kept for the same
  // receivers. False if that failed.
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
