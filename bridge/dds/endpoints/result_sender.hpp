// Publishes command results, one for each command. Results are volatile. The command of a requester
// that has just joined may arrive before its result reader is discovered; its result is held until
// then, for at most a second. Readers of other vendors get some more time: Cyclone DDS discards
// messages before the first heartbeat of a writer. Shortly after its result, an instance is
// unregistered, so that readers can free it.
//
// Sending never waits for a reader: the history is a ring (ResultType), and a slow reader loses the
// oldest results. Any thread. A thread of this object, not a Worker, sends held results and
// unregisters instances: its next action depends on instants that change when a reader matches.
#pragma once

#include <condition_variable>
#include <cstdint>
#include <deque>
#include <functional>
#include <map>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "bridge/dds/topics/conversion.hpp"
#include "bridge/dds/transport/domain.hpp"

namespace fieldcast {

class ResultSender : private dds::DataWriterListener {
 public:
  using GuidPrefix = rtps::GuidPrefix_t;

  ResultSender(Domain& domain, const std::string& label, std::function<UtcMapping()> clock,
               std::function<void(std::string)> on_problem);
  ~ResultSender() override;  // calls close()

  // Stores the participant that sends a requester's commands. The table is cleared when it has
  // kMaxRequesters; results of requesters that are not stored are not held.
  void remember(const std::string& requester, const GuidPrefix& participant);

  void send(const idl::CommandResult& result);

  // Sends held results, waits at most `linger` for the readers, removes the writer. Call it once.
  void close(Duration linger);

 private:
  static constexpr std::size_t kMaxRequesters = 4096;
  static constexpr std::size_t kMaxHeld = 1024;  // at the limit the oldest is sent regardless
  static constexpr Duration kHold = std::chrono::seconds{1};
  // Far longer than the delay of a writer's first heartbeat, also on a busy machine.
  static constexpr Duration kSettle = std::chrono::milliseconds{150};
  // Time between a result and the unregistration of its instance.
  static constexpr Duration kKeep = std::chrono::milliseconds{100};
  // Instances that may wait for unregistration: readers hold kMaxPendingCommands of them.
  static constexpr std::size_t kMaxKept = kMaxPendingCommands / 4;

  struct Requester {
    GuidPrefix participant;
    Instant first_seen;
  };
  struct Match {
    std::size_t readers = 0;
    Instant since;
  };
  struct Held {
    GuidPrefix participant;
    Instant until;
    idl::CommandResult result;
  };

  void on_publication_matched(dds::DataWriter* writer,
                              const dds::PublicationMatchedStatus& status) override;
  // Time until which a result is held; empty: send it now. REQUIRES: mutex_ held.
  [[nodiscard]] std::optional<Instant> hold_until(const Requester& requester, Instant now) const;
  void write(const idl::CommandResult& result);
  void let_go(const idl::CommandResult& sent);
  void run();
  // Removes and returns the held results that are due. REQUIRES: mutex_ held.
  [[nodiscard]] std::vector<idl::CommandResult> take_due(Instant now);
  // Removes and returns the instances to unregister now. REQUIRES: mutex_ held.
  [[nodiscard]] std::vector<idl::CommandResult> take_kept(Instant now);
  // Time of the next due result or instance. REQUIRES: mutex_ held.
  [[nodiscard]] std::optional<Instant> next_due() const;

  Domain& domain_;
  std::function<UtcMapping()> clock_;
  std::function<void(std::string)> on_problem_;
  dds::DataWriter* writer_ = nullptr;
  std::mutex mutex_;  // never held while writing
  std::condition_variable changed_;
  std::map<std::string, Requester> requesters_;
  std::map<GuidPrefix, Match> matched_;  // participants with a result reader
  std::deque<Held> held_;
  struct Kept {
    idl::CommandResult keys;  // keys of a sent result; other members are not set
    Instant since;
  };
  std::deque<Kept> kept_;
  bool closing_ = false;
  std::thread thread_;
};

}  // namespace fieldcast
