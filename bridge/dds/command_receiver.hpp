// Receives Command: converts it, finds out when it expires, and hands it on. Calls come on DDS
// threads.
#pragma once

#include <functional>
#include <map>
#include <mutex>
#include <optional>
#include <string>

#include "bridge/dds/domain.hpp"
#include "bridge/dds/requester_book.hpp"
#include "bridge/dds/topics/conversion.hpp"

namespace fieldcast {

// LIFESPAN is a QoS of the writer, but the library's reader applies its own. So the lifespans of
// the writers are collected from discovery. And who the participants are, by DDS Security.
class CommandLifespans : public DiscoveryListener {
 public:
  using Guid = rtps::GUID_t;
  // Also for writers that say "infinite": a late command never runs.
  static constexpr Duration kDefault = std::chrono::seconds{5};
  // A longer one counts as this: identities of commands are kept no longer.
  static constexpr Duration kLongest = std::chrono::hours{24};
  static constexpr std::size_t kMaxWriters = 4096;  // those beyond it get the default

  [[nodiscard]] Duration of(const Guid& writer) const;
  [[nodiscard]] RequesterBook& requesters() const { return requesters_; }

 private:
  void on_writer(const FoundWriter& writer) override;
  void on_participant(const FoundParticipant& participant) override;

  mutable std::mutex mutex_;
  std::map<Guid, Duration> lifespans_;
  mutable RequesterBook requesters_;
};

// When a command expires on the engine's clock. Its age is what the wall clocks of both machines
// say, but never negative.
[[nodiscard]] Instant expiry_of(UtcTime source, Duration lifespan, const UtcMapping& now);

// How long before `listening` the command was written: it was not for the bridge that listens now,
// although its writer may keep it and send it again. Nothing: since then. The source time is of the
// sender's clock, so that a sender whose clock is behind by d is refused for the first d of a
// bridge's life, and one whose clock is ahead by d may have what is younger than d repeated.
[[nodiscard]] std::optional<Duration> written_before(Instant listening, UtcTime source,
                                                     const UtcMapping& now);

// What a receiver listens to: all that comes without a partition (nothing), or what members write
// who are held to a bus. They write for no other bus: Domain::reader_of_bus().
using HeldTo = std::optional<std::string>;

// Who asks, as far as DDS Security says: "" without it, and nothing if the requester's name belongs
// to another subject. A result under that name would go to its owner: there is none then.
[[nodiscard]] std::optional<std::string> subject_of_requester(const Domain& domain,
                                                              RequesterBook& book,
                                                              const std::string& requester,
                                                              const CommandLifespans::Guid& writer);

class CommandReceiver : private dds::DataReaderListener {
 public:
  struct Handlers {
    std::function<UtcMapping()> clock;
    // Commands for other buses belong to other bridges.
    std::function<bool(const std::string& bus)> is_ours;
    std::function<void(const std::string& bus, Command command)> accepted;
    // Malformed, or older than this receiver.
    std::function<void(const std::string& bus, const idl::Command& command,
                       const MalformedCommand& why)>
        refused;
    // Called before accepted() or refused().
    std::function<void(const std::string& requester, const CommandLifespans::Guid& writer)>
        received;
    // For the log: a command was dropped.
    std::function<void(std::string text)> on_problem;
  };
  CommandReceiver(Domain& domain, const CommandLifespans& lifespans, Handlers handlers,
                  HeldTo bus = {});
  void close();  // nothing is handed on after it returns

 private:
  void on_data_available(dds::DataReader* reader) override;
  void take(const idl::Command& command, const dds::SampleInfo& info);

  Domain& domain_;
  const CommandLifespans& lifespans_;
  Handlers handlers_;
  const HeldTo bus_;
  const Instant listening_;  // since when
  dds::DataReader* reader_ = nullptr;
};

}  // namespace fieldcast
