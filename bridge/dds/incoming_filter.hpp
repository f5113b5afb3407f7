// What a participant with DDS Security takes from the network, before Fast DDS reads it.
//
// - Fast DDS 2.9.1 protects every message that it sends, but takes unprotected ones as well:
//   whoever knows the GUID of a bridge's writer, which stands in clear in each message, could send
//   samples in its name. Here a message in clear passes only where DDS Security has it in clear:
//   discovery of participants, the handshake, and the exchange of keys, whose submessages are
//   protected one by one.
// - Fast DDS 2.9.1 reads the list of revoked certificates once, when the participant is made, and
//   can neither read it anew nor drop a participant that it has let in. Here who is revoked later
//   is refused by the first six bytes of its GUID, which are the hash of its subject
//   (bridge/security/subject.hpp), and the library is told that it has left the domain.
//
// Any thread; at most kMaxParticipants are remembered.
#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <mutex>
#include <set>
#include <span>
#include <vector>

#include "bridge/security/subject.hpp"

namespace fieldcast {

// Whether DDS Security has a message in clear; RTPS 2.2, 9.4.
[[nodiscard]] bool may_be_in_clear(std::span<const std::uint8_t> message);

class IncomingFilter {
 public:
  using Bytes = std::vector<std::uint8_t>;
  static constexpr std::size_t kMaxParticipants = 4096;

  // `protects_messages`: what the governance says of whole messages.
  explicit IncomingFilter(bool protects_messages);

  // Every participant of this subject, from now on.
  void refuse(const security::GuidStart& subject);

  [[nodiscard]] bool takes(std::span<const std::uint8_t> message);
  // Messages that were not taken because they are in clear.
  [[nodiscard]] std::uint64_t refused_in_clear() const { return refused_in_clear_; }

  // Messages by which the library learns that refused participants have left, each once for every
  // thread that asks.
  [[nodiscard]] std::vector<Bytes> goodbyes();
  // The same for who has sent this message, which was not taken. Empty: it is not a refused one.
  [[nodiscard]] Bytes goodbye_of_sender(std::span<const std::uint8_t> message);

 private:
  using Prefix = std::array<std::uint8_t, 12>;  // of the GUIDs of a participant

  [[nodiscard]] bool is_refused(const Prefix& prefix) const;  // REQUIRES: mutex_ held
  [[nodiscard]] Bytes goodbye(const Prefix& prefix);

  const bool protects_messages_;
  const std::uint64_t number_;  // no two filters of a process share it
  std::atomic<std::uint64_t> refused_in_clear_{0};
  std::atomic<std::size_t> refused_participants_{0};
  std::atomic<bool> refuses_{false};
  std::mutex mutex_;
  std::set<Prefix> participants_;           // that sent something
  std::set<security::GuidStart> subjects_;  // that are refused
  std::vector<Prefix> refused_;             // of them, those that were here when they were refused
  std::atomic<std::uint32_t> goodbyes_{0};
};

}  // namespace fieldcast
