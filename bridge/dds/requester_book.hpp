// Who asks for something, by DDS Security: the subject of the certificate of each participant, and
// which subject a requester belongs to. Any thread.
//
// Fast DDS 2.9.1 does not give out the certificate that it has checked. It does check that the
// GUID of a participant begins with the hash of the certificate's subject (OMG formal/18-04-01,
// 9.3.3). So a participant says its subject itself, in its identity token, and what has another
// hash than its GUID is not taken. 47 bits of the hash are in the GUID: enough against chance and
// outsiders. A member that computes some 2^47 names until one fits could show a false name here,
// but gets no right by it: rights are checked by the library, on the certificate itself.
#pragma once

#include <cstdint>
#include <deque>
#include <map>
#include <mutex>
#include <optional>
#include <string>
#include <string_view>

#include "bridge/dds/fastdds.hpp"

namespace fieldcast {

class RequesterBook {
 public:
  using Participant = rtps::GuidPrefix_t;
  static constexpr std::size_t kMaxParticipants = 4096;  // those beyond it are unknown
  static constexpr std::size_t kMaxRequesters = 4096;    // beyond it the oldest is forgotten
  static constexpr std::string_view kUnknown = "unknown subject";

  // `slashed`: "/O=Fieldcast/OU=plant/CN=mes-1.2".
  void found(const Participant& participant, std::string_view slashed);
  void lost(const Participant& participant);

  // "plant mes-1", or kUnknown.
  [[nodiscard]] std::string subject_of(const Participant& participant) const;

  // The first that uses the name of a requester has it. False: it belongs to another subject.
  [[nodiscard]] bool bind(const std::string& requester, const std::string& subject);

 private:
  mutable std::mutex mutex_;
  std::map<Participant, std::string> subjects_;
  std::map<std::string, std::string> owners_;  // of requesters
  std::deque<std::string> oldest_;             // requester first
};

}  // namespace fieldcast
