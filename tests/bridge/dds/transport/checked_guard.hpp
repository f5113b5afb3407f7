// A guard in virtual time, for the tests of its rules.
#pragma once

#include "bridge/dds/guard/datagram_guard.hpp"
#include "tests/bridge/dds/transport/rtps_datagrams.hpp"

namespace fieldcast::testing {

inline ParticipantPrefix numbered(std::uint32_t number) {
  ParticipantPrefix prefix = kSender;
  for (std::size_t i = 0; i < 4; ++i) prefix[8 + i] = static_cast<std::uint8_t>(number >> 8 * i);
  return prefix;
}

struct Checked {
  explicit Checked(const RtpsLimits& limits = {}) : guard(limits) {}

  std::string cause_of(const Datagram& datagram, std::uint8_t address = 1) {
    const auto verdict = guard.check(datagram, {address}, now, scratch);
    bytes.assign(verdict.bytes.begin(), verdict.bytes.end());
    before = verdict.before;
    return verdict.fault ? std::string(to_text(*verdict.fault)) : "none";
  }
  void wait(Duration time) { now += time; }

  DatagramGuard guard;
  Instant now{std::chrono::seconds{1000}};
  Datagram scratch, bytes, before;
};

}  // namespace fieldcast::testing
