// Several RTPS messages of one sender as one: the header once, then the submessages of each in
// their order (RTPS 2.2, 8.3.4: a message is a header and any number of submessages, and what one
// of them sets, as INFO_DST does, holds for those behind it). Pure; one owner.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace fieldcast {

class JoinedMessage {
 public:
  // Bytes of the whole.
  explicit JoinedMessage(std::size_t most_bytes) : most_bytes_(most_bytes) {}

  // False, and nothing changes: it would become too long, comes from another sender, or is no
  // message whose submessages keep their meaning behind others.
  [[nodiscard]] bool append(std::span<const std::uint8_t> message);

  [[nodiscard]] bool empty() const { return bytes_.empty(); }
  // Valid until the next call.
  [[nodiscard]] std::span<const std::uint8_t> whole();
  void clear();

 private:
  std::size_t most_bytes_;
  std::vector<std::uint8_t> bytes_;
  std::vector<std::uint8_t> tail_;  // the statistics of the library, which must come last
  bool directed_ = false;           // an INFO_DST is in force at the end
};

}  // namespace fieldcast
