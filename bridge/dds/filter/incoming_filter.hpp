// Filters the messages from the network that a participant with DDS Security accepts, before Fast
// DDS reads them.
//
// - Fast DDS 2.9.1 protects every message that it sends, but also accepts unprotected ones. An
//   attacker who knows the GUID of a bridge's writer, which is in clear in each message, could send
//   samples in its name. Here, a message in clear passes only if DDS Security requires it in clear:
//   discovery of participants, the handshake, and the exchange of keys, whose submessages are
//   protected individually.
// - Fast DDS 2.9.1 reads the list of revoked certificates once, when the participant is created. It
//   cannot read it again, and cannot remove an authenticated participant. Here, a participant that
//   is revoked later is refused by the first six bytes of its GUID, which are the hash of its
//   subject (bridge/security/subject.hpp), and the library receives a message that it has left the
//   domain. 3.x accepts no such message in clear; MemberWatch removes the participant there.
//
// - Fast DDS 2.9.1 and 3.1.2 do not expose the certificates that they have checked. A participant's
//   announcement contains the subject of its certificate. Here, the subject is stored if its hash
//   is the start of the participant's GUID, which the library compares with the certificate.
//
// Any thread; at most kMaxParticipants are remembered.
#pragma once

#include <atomic>
#include <cstdint>
#include <map>
#include <mutex>
#include <set>
#include <span>
#include <string>
#include <vector>

#include "bridge/dds/guard/parameter_list.hpp"
#include "bridge/security/subject.hpp"

namespace fieldcast {

// Returns true if DDS Security sends such a message in clear; RTPS 2.2, 9.4.
[[nodiscard]] bool may_be_in_clear(std::span<const std::uint8_t> message);

class IncomingFilter {
 public:
  using Bytes = std::vector<std::uint8_t>;
  static constexpr std::size_t kMaxParticipants = 4096;

  // `protects_messages`: true if the governance protects whole messages.
  explicit IncomingFilter(bool protects_messages);

  // Returns the participants of the subject that have sent a message.
  std::vector<ParticipantPrefix> refuse(const security::GuidStart& subject);

  [[nodiscard]] bool takes(std::span<const std::uint8_t> message);
  // Number of messages refused because they are in clear.
  [[nodiscard]] std::uint64_t refused_in_clear() const { return refused_in_clear_; }

  // Subject in the participant's announcement, for example "/O=Fieldcast/OU=plant/CN=mes-1.2".
  // Empty if none was received, or if its hash is not the start of the GUID.
  [[nodiscard]] std::string subject_of(const ParticipantPrefix& participant) const;

  // Messages that refused participants have left, each once for every calling thread.
  [[nodiscard]] std::vector<Bytes> goodbyes();
  // Such a message for the sender of a refused one. Empty if the sender is not refused.
  [[nodiscard]] Bytes goodbye_of_sender(std::span<const std::uint8_t> message);

 private:
  using Prefix = ParticipantPrefix;

  void note_subject(const Prefix& prefix, std::span<const std::uint8_t> message);
  [[nodiscard]] bool is_refused(const Prefix& prefix) const;  // REQUIRES: mutex_ held
  [[nodiscard]] Bytes goodbye(const Prefix& prefix);

  const bool protects_messages_;
  const std::uint64_t number_;  // unique among the filters of a process
  std::atomic<std::uint64_t> refused_in_clear_{0};
  std::atomic<std::size_t> refused_participants_{0};
  std::atomic<bool> refuses_{false};
  mutable std::mutex mutex_;
  std::set<Prefix> participants_;           // that sent a message
  std::map<Prefix, std::string> stated_;    // subjects in announcements
  std::set<security::GuidStart> subjects_;  // refused subjects
  std::vector<Prefix> refused_;  // refused participants that were present when they were refused
  std::atomic<std::uint32_t> goodbyes_{0};
};

}  // namespace fieldcast
