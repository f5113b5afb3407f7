// Conditions under which a bridge accepts `Command` and `AlarmAction`: the expiry, the target
// bridge, and the requester's identity.
#pragma once

#include <map>
#include <mutex>
#include <optional>
#include <string>

#include "bridge/dds/receivers/requester_registry.hpp"
#include "bridge/dds/transport/domain.hpp"
#include "core/base/time.hpp"

namespace fieldcast {

// Collects the lifespans of writers from discovery, because LIFESPAN is a QoS of the writer, but
// the library's reader applies its own. Also collects the DDS Security subjects of participants.
class RequestWriters : public DiscoveryListener {
 public:
  using Guid = rtps::GUID_t;
  // Also used for writers with an infinite lifespan: a late command never runs.
  static constexpr Duration kDefault = std::chrono::seconds{5};
  // Longer lifespans are reduced to this one: identities of commands are kept no longer.
  static constexpr Duration kLongest = std::chrono::hours{24};
  static constexpr std::size_t kMaxWriters = 4096;  // further writers get the default

  [[nodiscard]] Duration lifespan_of(const Guid& writer) const;
  // The subject of the writer's participant, for example "bridge line-7", or
  // RequesterRegistry::kUnknown. Empty without DDS Security.
  [[nodiscard]] std::string subject_of(const Domain& domain, const Guid& writer) const;
  // The subject of a requester: "" without DDS Security, `std::nullopt` if the requester's name
  // belongs to another subject. Such a request gets no result, because the result would go to the
  // owner of the name.
  [[nodiscard]] std::optional<std::string> subject_of(const Domain& domain,
                                                      const std::string& requester,
                                                      const Guid& writer) const;

 private:
  void on_writer(const FoundWriter& writer) override;
  void on_participant(const FoundParticipant& participant) override;

  mutable std::mutex mutex_;
  std::map<Guid, Duration> lifespans_;
  mutable RequesterRegistry requesters_;
};

// Expiry of a request on the engine's clock. Its age is the difference of the wall clocks of both
// machines, never negative.
[[nodiscard]] Instant expiry_of(UtcTime source, Duration lifespan, const UtcMapping& now);

// Both clock readings, for the message about a late request: "written at .., received at .. by this
// bridge's clock: ..". Empty if the request has no source time.
[[nodiscard]] std::string clocks_text(UtcTime source, const UtcMapping& now);

// How long before `listening` the request was written; `std::nullopt` if it was written later. An
// older request was not for the bridge that listens now, although its writer may keep and repeat
// it. The source time is of the sender's clock. If that clock is behind by d, requests are refused
// for the first d of a bridge's life. If it is ahead by d, requests younger than d may be repeated.
[[nodiscard]] std::optional<Duration> written_before(Instant listening, UtcTime source,
                                                     const UtcMapping& now);

}  // namespace fieldcast
