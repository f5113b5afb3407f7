// Stores the DDS Security subject of each participant, and the subject that each requester name
// belongs to. Any thread.
//
// Fast DDS 2.9.1 does not expose the certificate that it has checked. It does check that the GUID
// of a participant begins with the hash of the certificate's subject (OMG formal/18-04-01, 9.3.3).
// So the subject is read from the participant's identity token, and ignored if its hash differs
// from the GUID. The GUID contains 47 bits of the hash: enough against chance and outsiders. A
// member that computes some 2^47 names could show a false name here, but gains no right by it: the
// library checks rights on the certificate itself.
#pragma once

#include <cstdint>
#include <deque>
#include <map>
#include <mutex>
#include <optional>
#include <string>
#include <string_view>

#include "bridge/dds/library/fastdds.hpp"

namespace fieldcast {

class RequesterRegistry {
 public:
  using Participant = rtps::GuidPrefix_t;
  static constexpr std::size_t kMaxParticipants = 4096;  // further ones are unknown
  static constexpr std::size_t kMaxRequesters = 4096;    // at the limit the oldest is removed
  static constexpr std::string_view kUnknown = "unknown subject";

  // `slashed` is for example "/O=Fieldcast/OU=plant/CN=mes-1.2".
  void found(const Participant& participant, std::string_view slashed);
  void lost(const Participant& participant);

  // For example "plant mes-1", or kUnknown.
  [[nodiscard]] std::string subject_of(const Participant& participant) const;

  // Assigns the requester name to the subject that uses it first. Returns false if it belongs to
  // another subject.
  [[nodiscard]] bool bind(const std::string& requester, const std::string& subject);

 private:
  mutable std::mutex mutex_;
  std::map<Participant, std::string> subjects_;
  std::map<std::string, std::string> owners_;  // by requester
  std::deque<std::string> oldest_;             // requesters, oldest first
};

}  // namespace fieldcast
