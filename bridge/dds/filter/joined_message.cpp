#include "bridge/dds/filter/joined_message.hpp"

#include <algorithm>
#include <array>
#include <cstring>
#include <optional>

#include "bridge/dds/guard/rtps_message.hpp"

namespace fieldcast {

namespace {

// Resets the destination to every participant (RTPS 2.2, 9.4.5.8, with GUIDPREFIX_UNKNOWN).
constexpr std::array<std::uint8_t, 16> kToAll = {static_cast<std::uint8_t>(Submessage::kInfoDst),
                                                 kOwnOrder, kOwnOrder == kLittleEndianFlag ? 12 : 0,
                                                 kOwnOrder == kLittleEndianFlag ? 0 : 12};

// The content of a message after its header.
struct Content {
  std::size_t end = kMessageHeader;  // of the part before the statistics
  std::optional<Submessage> first;
  bool directed = false;
};

std::uint16_t length_at(std::span<const std::uint8_t> message, std::size_t begin) {
  std::uint16_t length;
  std::memcpy(&length, message.data() + begin + 2, sizeof length);
  return length;
}

// Returns `std::nullopt` for a message that cannot be appended to another message.
std::optional<Content> content_of(std::span<const std::uint8_t> message) {
  if (message.size() < kMessageHeader || std::memcmp(message.data(), "RTPS", 4) != 0)
    return std::nullopt;
  Content content;
  bool timed = false;
  for (std::size_t begin = kMessageHeader; begin != message.size();) {
    if (begin + kSubmessageHeader > message.size()) return std::nullopt;
    const auto kind = static_cast<Submessage>(message[begin]);
    const std::uint16_t length = length_at(message, begin);
    const std::size_t end = begin + kSubmessageHeader + length;
    // A length of 0 may mean "to the end", and each submessage begins at a multiple of 4 (9.4.1,
    // 9.4.5.1.3).
    if ((message[begin + 1] & kLittleEndianFlag) != kOwnOrder || length == 0 || length % 4 != 0 ||
        end > message.size())
      return std::nullopt;
    switch (kind) {
      case Submessage::kInfoTs: timed = true; break;
      case Submessage::kInfoDst: content.directed = true; break;
      case Submessage::kData:
        if (!timed) return std::nullopt;  // it would get the timestamp of the message before it
        break;
      case Submessage::kPad:
      case Submessage::kHeartbeat:
      case Submessage::kGap: break;
      case Submessage::kStatistics:
        if (end != message.size()) return std::nullopt;
        return content.first ? std::optional(content) : std::nullopt;
      default: return std::nullopt;
    }
    if (!content.first) content.first = kind;
    content.end = begin = end;
  }
  return content.first ? std::optional(content) : std::nullopt;
}

}  // namespace

bool JoinedMessage::append(std::span<const std::uint8_t> message) {
  const auto content = content_of(message);
  if (!content) return false;
  const std::size_t skipped = bytes_.empty() ? 0 : kMessageHeader;
  const bool redirect = directed_ && content->first != Submessage::kInfoDst;
  if (bytes_.size() + (redirect ? kToAll.size() : 0) + message.size() - skipped > most_bytes_)
    return false;
  if (!bytes_.empty() &&
      !std::equal(bytes_.begin(), bytes_.begin() + kMessageHeader, message.begin()))
    return false;
  if (redirect) bytes_.insert(bytes_.end(), kToAll.begin(), kToAll.end());
  const auto at = [&](std::size_t offset) {
    return message.begin() + static_cast<std::ptrdiff_t>(offset);
  };
  bytes_.insert(bytes_.end(), at(skipped), at(content->end));
  tail_.assign(at(content->end), message.end());
  directed_ = content->directed || (directed_ && !redirect);
  return true;
}

std::span<const std::uint8_t> JoinedMessage::whole() {
  bytes_.insert(bytes_.end(), tail_.begin(), tail_.end());
  tail_.clear();
  return bytes_;
}

void JoinedMessage::clear() {
  bytes_.clear();
  tail_.clear();
  directed_ = false;
}

}  // namespace fieldcast
