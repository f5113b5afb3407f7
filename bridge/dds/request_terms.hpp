// On which terms a bridge takes what is asked of it, Command and AlarmAction alike: when it
// expires, whether it was for this bridge, and who asks.
#pragma once

#include <map>
#include <mutex>
#include <optional>
#include <string>

#include "bridge/dds/domain.hpp"
#include "bridge/dds/requester_book.hpp"
#include "bridge/dds/topics/utc_mapping.hpp"

namespace fieldcast {

// LIFESPAN is a QoS of the writer, but the library's reader applies its own. So the lifespans of
// the writers are collected from discovery. And who the participants are, by DDS Security.
class RequestWriters : public DiscoveryListener {
 public:
  using Guid = rtps::GUID_t;
  // Also for writers that say "infinite": a late command never runs.
  static constexpr Duration kDefault = std::chrono::seconds{5};
  // A longer one counts as this: identities of commands are kept no longer.
  static constexpr Duration kLongest = std::chrono::hours{24};
  static constexpr std::size_t kMaxWriters = 4096;  // those beyond it get the default

  [[nodiscard]] Duration lifespan_of(const Guid& writer) const;
  // The subject of the participant of a writer, "bridge line-7", or RequesterBook::kUnknown. Empty
  // without DDS Security.
  [[nodiscard]] std::string subject_of(const Domain& domain, const Guid& writer) const;
  // Who asks: "" without DDS Security, and nothing if the requester's name belongs to another
  // subject. A result under that name would go to its owner: there is none then.
  [[nodiscard]] std::optional<std::string> subject_of(const Domain& domain,
                                                      const std::string& requester,
                                                      const Guid& writer) const;

 private:
  void on_writer(const FoundWriter& writer) override;
  void on_participant(const FoundParticipant& participant) override;

  mutable std::mutex mutex_;
  std::map<Guid, Duration> lifespans_;
  mutable RequesterBook requesters_;
};

// When a request expires on the engine's clock. Its age is what the wall clocks of both machines
// say, but never negative.
[[nodiscard]] Instant expiry_of(UtcTime source, Duration lifespan, const UtcMapping& now);

// Both clocks, for the reason of a request that is too late by them: "written at .., received at ..
// by this bridge's clock: ..". Empty if the request has no source time.
[[nodiscard]] std::string clocks_text(UtcTime source, const UtcMapping& now);

// How long before `listening` the request was written: it was not for the bridge that listens now,
// although its writer may keep it and send it again. Nothing: since then. The source time is of the
// sender's clock, so that a sender whose clock is behind by d is refused for the first d of a
// bridge's life, and one whose clock is ahead by d may have what is younger than d repeated.
[[nodiscard]] std::optional<Duration> written_before(Instant listening, UtcTime source,
                                                     const UtcMapping& now);

}  // namespace fieldcast
