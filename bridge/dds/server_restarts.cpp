#include "bridge/dds/server_restarts.hpp"

#include <algorithm>

#include "bridge/dds/fastdds.hpp"
#include "bridge/dds/participant_note.hpp"
#include "bridge/dds/rtps_message.hpp"

namespace fieldcast {

namespace {

using Span = std::span<const std::uint8_t>;
using Announcement = ServerRestarts::Announcement;
using Heartbeat = ServerRestarts::Heartbeat;

constexpr std::size_t kSenderOffset = 8;

std::uint64_t integer_at(Span bytes, std::size_t at, std::size_t size, bool little) {
  std::uint64_t value = 0;
  for (std::size_t i = 0; i < size; ++i)
    value = value << 8 | bytes[at + (little ? size - 1 - i : i)];
  return value;
}

// RTPS 2.2, 9.3.2: of numbers and of instants the upper half comes first.
std::uint64_t halves_at(Span bytes, std::size_t at, bool little) {
  return integer_at(bytes, at, 4, little) << 32 | integer_at(bytes, at + 4, 4, little);
}

bool is_of_participants(Span part, std::size_t writer) {
  return std::equal(kParticipantWriter.begin(), kParticipantWriter.end(), part.begin() + writer);
}

// RTPS 2.2, 9.4.5: INFO_TS 09 flags length | instant(8)
//                  DATA 15 flags length | extra(2) qos-offset(2) reader(4) writer(4) number(8)
//                  HEARTBEAT 07 flags length | reader(4) writer(4) first(8) last(8) count(4)
constexpr std::size_t kWriterInData = kSubmessageHeader + 8, kNumberInData = kWriterInData + 4;
constexpr std::size_t kWriterInHeartbeat = kSubmessageHeader + 4;
constexpr std::size_t kLastInHeartbeat = kWriterInHeartbeat + 12;
constexpr std::size_t kCountInHeartbeat = kLastInHeartbeat + 8;

// What the writer of participants says in this message, in its order.
template <class OnAnnouncement, class OnHeartbeat>
void for_each_news(Span message, OnAnnouncement on_announcement, OnHeartbeat on_heartbeat) {
  std::uint64_t stamp = 0;
  for (std::size_t at = kMessageHeader; at + kSubmessageHeader <= message.size();) {
    const Span rest = message.subspan(at);
    const bool little = (rest[1] & kLittleEndian) != 0;
    const std::size_t length = integer_at(rest, 2, 2, little);
    // RTPS 2.2, 9.4.5.1.3: 0: to the end of the message
    const std::size_t size = length == 0 ? rest.size() : kSubmessageHeader + length;
    if (size > rest.size()) return;
    const Span part = rest.first(size);
    switch (static_cast<Submessage>(part[0])) {
      case Submessage::kInfoTs:
        stamp = length == 8 ? halves_at(part, kSubmessageHeader, little) : 0;
        break;
      case Submessage::kData:
        if (size >= kNumberInData + 8 && is_of_participants(part, kWriterInData) && stamp != 0)
          on_announcement(Announcement{halves_at(part, kNumberInData, little), stamp});
        break;
      case Submessage::kHeartbeat:
        if (size >= kCountInHeartbeat + 4 && is_of_participants(part, kWriterInHeartbeat)) {
          on_heartbeat(Heartbeat{halves_at(part, kLastInHeartbeat, little),
                                 integer_at(part, kCountInHeartbeat, 4, little)});
        }
        break;
      default: break;
    }
    at += size;
  }
}

}  // namespace

void ServerRestarts::on_server(unsigned identity, bool here) {
  if (identity >= kMostServers) return;
  const std::lock_guard lock(mutex_);
  servers_[identity].here = here;
}

bool ServerRestarts::is_another(Server& server, const Announcement& announcement) {
  Announcement& known = server.announcement;
  if (announcement.number > known.number) {
    known = announcement;
    return false;
  }
  return announcement.stamp > known.stamp;
}

bool ServerRestarts::is_another(Server& server, const Heartbeat& heartbeat, Instant now) {
  if (now - server.highest_since >= kLongestDelay) {
    server.settled = server.highest.count;
    server.highest_since = now;
  }
  server.highest = {std::max(server.highest.last, heartbeat.last),
                    std::max(server.highest.count, heartbeat.count)};
  return heartbeat.count < server.settled;
}

ServerRestarts::Bytes ServerRestarts::goodbye_before(Span message, Instant now) {
  if (message.size() <= kMessageHeader) return {};
  rtps::GuidPrefix_t prefix;
  std::copy_n(message.begin() + kSenderOffset, rtps::GuidPrefix_t::size, prefix.value);
  const auto identity = server_identity(prefix);
  if (!identity || *identity >= kMostServers) return {};
  const std::lock_guard lock(mutex_);
  Server& server = servers_[*identity];
  bool another = server.heard != kNever && now - server.heard >= kSilence;
  server.heard = now;
  std::uint64_t last = std::max(server.announcement.number, server.highest.last);
  const auto restarted = [&](auto... news) {
    if (!is_another(server, news...)) return;
    another = true;
    last = std::max({last, server.announcement.number, server.highest.last});
    server = Server{.here = server.here, .heard = now};
    (void)is_another(server, news...);  // the first of the new one
  };
  for_each_news(
      message, [&](const Announcement& one) { restarted(one); },
      [&](const Heartbeat& one) { restarted(one, now); });
  if (!another || !server.here) return {};
  server.here = false;  // once
  ParticipantPrefix of{};
  std::copy_n(prefix.value, of.size(), of.begin());
  return participant_gone(of, last + 1, true);
}

}  // namespace fieldcast
