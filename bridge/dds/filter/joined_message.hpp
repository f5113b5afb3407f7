// Joins several RTPS messages of one sender into one: the header once, then the submessages of each
// in their order. RTPS 2.2, 8.3.4: a message is a header and any number of submessages, and a state
// that one sets, as INFO_DST does, holds for the following ones. Pure; one owner.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace fieldcast {

class JoinedMessage {
 public:
  explicit JoinedMessage(std::size_t most_bytes) : most_bytes_(most_bytes) {}

  // Returns false, without a change, if the result would be too long, the sender differs, or the
  // message cannot follow others without a change of meaning.
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

}  // namespace fieldcast
