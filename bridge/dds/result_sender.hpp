// Publishes command results, one for each command.
//
// Results are volatile. A requester that has just joined may have had its command received before
// its reader was discovered; its result is held until then, for at most a second. Readers of other
// vendors get a moment more: Cyclone DDS throws away what comes before the first heartbeat of a
// writer, and takes that heartbeat for the beginning. A moment after its result, an instance is let
// go, so that readers keep nothing of it.
//
// Nobody is waited for: the writer is a ring (ResultType), and a reader that takes nothing loses
// the oldest. Any thread; one of its own sends what was held, and lets instances go.
//
// That thread is no Worker with a BoundedQueue: what it does next depends on instants that a match
// changes while results wait, not on the order in which they came.
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

#include "bridge/dds/domain.hpp"
#include "bridge/dds/topics/conversion.hpp"

namespace fieldcast {

class ResultSender : private dds::DataWriterListener {
 public:
  using GuidPrefix = rtps::GuidPrefix_t;

  ResultSender(Domain& domain, const std::string& label, std::function<UtcMapping()> clock,
               std::function<void(std::string)> on_problem);
  ~ResultSender() override;  // close()

  // The participant that a requester's commands come from. At most kMaxRequesters are remembered;
  // the results of others are not held.
  void remember(const std::string& requester, const GuidPrefix& participant);

  void send(const idl::CommandResult& result);

  // Sends what is held, waits at most `linger` until every reader has what was sent, and removes
  // the writer. Once.
  void close(Duration linger);

 private:
  static constexpr std::size_t kMaxRequesters = 4096;
  static constexpr std::size_t kMaxHeld = 1024;  // the oldest is sent regardless
  static constexpr Duration kHold = std::chrono::seconds{1};
  // Far more than the delay of a writer's first heartbeat, also on a busy machine.
  static constexpr Duration kSettle = std::chrono::milliseconds{150};
  // An instance is let go this long after its result.
  static constexpr Duration kKeep = std::chrono::milliseconds{100};
  // Instances that may wait until they are let go: readers hold kMaxPendingCommands of them.
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
  // When a result may leave; nothing: at once. REQUIRES: mutex_ held.
  [[nodiscard]] std::optional<Instant> hold_until(const Requester& requester, Instant now) const;
  void write(const idl::CommandResult& result);
  void let_go(const idl::CommandResult& sent);
  void run();  // the thread
  // The held results that are to be sent now. REQUIRES: mutex_ held.
  [[nodiscard]] std::vector<idl::CommandResult> take_due(Instant now);
  // The instances that are to be let go now. REQUIRES: mutex_ held.
  [[nodiscard]] std::vector<idl::CommandResult> take_kept(Instant now);
  // When the first of both is due. REQUIRES: mutex_ held.
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
    idl::CommandResult keys;  // of a result that was sent; nothing else is filled in
    Instant since;
  };
  std::deque<Kept> kept_;
  bool closing_ = false;
  std::thread thread_;
};

}  // namespace fieldcast
