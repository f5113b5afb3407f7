#include "bridge/dds/transport/server_restarts.hpp"

#include <algorithm>
#include <optional>
#include <utility>

#include "bridge/dds/guard/parameter_list.hpp"
#include "bridge/dds/guard/rtps_message.hpp"
#include "bridge/dds/library/fastdds.hpp"

namespace fieldcast {

namespace {

using Span = std::span<const std::uint8_t>;
using Announcement = ServerRestarts::Announcement;
using Heartbeat = ServerRestarts::Heartbeat;
using Acknowledgement = ServerRestarts::Acknowledgement;

constexpr std::size_t kSenderOffset = 8;

std::uint64_t integer_at(Span bytes, std::size_t at, std::size_t size, bool little) {
  std::uint64_t value = 0;
  for (std::size_t i = 0; i < size; ++i)
    value = value << 8 | bytes[at + (little ? size - 1 - i : i)];
  return value;
}

// RTPS 2.2, 9.3.2: the upper half of numbers and instants is first.
std::uint64_t halves_at(Span bytes, std::size_t at, bool little) {
  return integer_at(bytes, at, 4, little) << 32 | integer_at(bytes, at + 4, 4, little);
}

bool is_of_participants(Span part, std::size_t writer) {
  return std::equal(kParticipantWriter.begin(), kParticipantWriter.end(), part.begin() + writer);
}

// RTPS 2.2, 9.4.5: INFO_TS 09 flags length | instant(8)
//                  DATA 15 flags length | extra(2) qos-offset(2) reader(4) writer(4) number(8)
//                  HEARTBEAT 07 flags length | reader(4) writer(4) first(8) last(8) count(4)
constexpr std::size_t kStampSize = kSubmessageHeader + 8;
constexpr std::size_t kWriterInData = kSubmessageHeader + 8, kNumberInData = kWriterInData + 4;
constexpr std::size_t kWriterInHeartbeat = kSubmessageHeader + 4;
constexpr std::size_t kLastInHeartbeat = kWriterInHeartbeat + 12;
constexpr std::size_t kCountInHeartbeat = kLastInHeartbeat + 8;
//                  ACKNACK 06 flags length | reader(4) writer(4) base(8) bits(4) map(4).. count(4)
constexpr std::size_t kWriterInAckNack = kSubmessageHeader + 4;
constexpr std::size_t kBaseInAckNack = kWriterInAckNack + 4, kBitsInAckNack = kBaseInAckNack + 8;
constexpr std::size_t kMapInAckNack = kBitsInAckNack + 4;
// RTPS 2.2, 9.3.1.3: the writers that announce the endpoints of a participant.
constexpr EntityBytes kWritersWriter{0, 0, 3, 0xc2}, kReadersWriter{0, 0, 4, 0xc2};

ParticipantPrefix prefix_of(Span message) {
  ParticipantPrefix prefix{};
  std::copy_n(message.begin() + kSenderOffset, prefix.size(), prefix.begin());
  return prefix;
}

std::optional<Acknowledgement> acknowledgement_in(Span part, bool little) {
  if (part.size() < kMapInAckNack) return std::nullopt;
  const auto is_of = [&](const EntityBytes& writer) {
    return std::equal(writer.begin(), writer.end(), part.begin() + kWriterInAckNack);
  };
  const bool of_writers = is_of(kWritersWriter);
  if (!of_writers && !is_of(kReadersWriter)) return std::nullopt;
  const std::uint64_t bits = integer_at(part, kBitsInAckNack, 4, little);
  const std::size_t count = kMapInAckNack + 4 * ((bits + 31) / 32);
  if (count + 4 > part.size()) return std::nullopt;
  return Acknowledgement{of_writers, halves_at(part, kBaseInAckNack, little),
                         integer_at(part, count, 4, little)};
}

// Calls the callbacks, in message order, for announcements, heartbeats and acknowledgements.
template <class OnAnnouncement, class OnHeartbeat, class OnAcknowledgement>
void for_each_news(Span message, OnAnnouncement on_announcement, OnHeartbeat on_heartbeat,
                   OnAcknowledgement on_acknowledgement) {
  std::uint64_t stamp = 0;
  for_each_submessage(message, [&](const SubmessageView& one) {
    const bool little = one.little;
    const Span part = one.bytes;
    switch (one.kind) {
      case Submessage::kInfoTs:
        stamp = part.size() == kStampSize ? halves_at(part, kSubmessageHeader, little) : 0;
        break;
      case Submessage::kData:
        if (part.size() >= kNumberInData + 8 && is_of_participants(part, kWriterInData) &&
            stamp != 0)
          on_announcement(Announcement{halves_at(part, kNumberInData, little), stamp});
        break;
      case Submessage::kHeartbeat:
        if (part.size() >= kCountInHeartbeat + 4 && is_of_participants(part, kWriterInHeartbeat)) {
          on_heartbeat(Heartbeat{halves_at(part, kLastInHeartbeat, little),
                                 integer_at(part, kCountInHeartbeat, 4, little)});
        }
        break;
      case Submessage::kAckNack:
        if (const auto seen = acknowledgement_in(part, little)) on_acknowledgement(*seen);
        break;
      default: break;
    }
    return true;
  });
}

}  // namespace

void ServerRestarts::on_server(unsigned identity, bool here) {
  if (identity >= kMostServers) return;
  const std::lock_guard lock(mutex_);
  servers_[identity].here = here;
}

void ServerRestarts::on_other(const ParticipantPrefix& prefix, bool here) {
  const std::lock_guard lock(mutex_);
  if (const auto found = others_.find(prefix); found != others_.end()) {
    found->second.announced = latest_;
    if (!here) others_.erase(found);
  } else if (here && others_.size() < kMostOthers) {
    others_.try_emplace(prefix, Other{.heard = latest_, .announced = latest_});
  }
}

void ServerRestarts::heard(const ParticipantPrefix& prefix, Instant now) {
  latest_ = now;
  const auto found = others_.find(prefix);
  if (found == others_.end()) return;
  if (now - found->second.heard >= kSilence) found->second.returned = now;
  found->second.heard = now;
}

std::vector<ParticipantPrefix> ServerRestarts::silent_ones(Instant now) const {
  std::vector<ParticipantPrefix> silent;
  for (const auto& [prefix, other] : others_) {
    const bool is_silent = now - other.heard >= kSilence || now < other.returned + kReturn;
    // The server has just announced this participant and does not repeat that.
    const bool is_told = now - other.announced < kReturn;
    if (is_silent && !is_told && silent.size() < kMostEnds) silent.push_back(prefix);
  }
  return silent;
}

std::vector<ParticipantPrefix> ServerRestarts::absent_ones(const Server& server,
                                                           Instant now) const {
  std::vector<ParticipantPrefix> absent;
  if (server.anew == kNever || now - server.anew < kAbsence) return absent;
  for (const auto& [prefix, other] : others_) {
    const bool is_absent = other.announced < server.anew && now - other.heard >= kAbsence;
    if (is_absent && absent.size() < kMostEnds) absent.push_back(prefix);
  }
  return absent;
}

// A later acknowledgement with base 0 after one with another base: the server has a new reader.
bool ServerRestarts::begins_anew(Server& server, const Acknowledgement& one) {
  std::uint64_t& known = server.acknowledged[one.of_writers ? 1 : 0];
  if (one.base != 0) {
    known = std::max(known, one.count);
    return false;
  }
  if (known == 0 || one.count <= known) return false;
  server.acknowledged = {};
  return true;
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
  const ParticipantPrefix sender = prefix_of(message);
  rtps::GuidPrefix_t prefix;
  std::copy(sender.begin(), sender.end(), prefix.value);
  const auto identity = server_identity(prefix);
  const std::lock_guard lock(mutex_);
  heard(sender, now);
  if (!identity || *identity >= kMostServers) return {};
  Server& server = servers_[*identity];
  bool another = server.heard != kNever && now - server.heard >= kSilence;
  server.heard = now;
  std::uint64_t last = std::max(server.announcement.number, server.highest.last);
  const auto restarted = [&](auto... news) {
    if (!is_another(server, news...)) return;
    another = true;
    last = std::max({last, server.announcement.number, server.highest.last});
    server = Server{.here = server.here, .heard = now, .anew = now};
    (void)is_another(server, news...);  // the first message of the restarted server
  };
  for_each_news(
      message, [&](const Announcement& one) { restarted(one); },
      [&](const Heartbeat& one) { restarted(one, now); },
      [&](const Acknowledgement& one) {
        if (begins_anew(server, one)) server.begins_anew = true;
      });
  if (!server.here) return {};
  std::vector<ParticipantPrefix> ends;
  if (std::exchange(server.begins_anew, false)) {
    server.anew = now;
    another = true;
    ends = silent_ones(now);
  } else {
    ends = absent_ones(server, now);
  }
  if (!another && ends.empty()) return {};
  server.here = false;  // notify only once
  return participants_gone(ends, sender, last + 1);
}

}  // namespace fieldcast
