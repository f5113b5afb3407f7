// This bridge as a member of its standby group: runs the election on its own thread, sends the
// member's state ten times a second, watches processes of members on the same kernel, and notes
// which writes begin. Any thread; handlers are called on the group's thread unless stated otherwise
// and must not block.
#pragma once

#include <functional>
#include <map>
#include <mutex>
#include <optional>
#include <set>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "bridge/base/file_descriptor.hpp"
#include "bridge/standby/master_lease.hpp"
#include "bridge/standby/standby_values.hpp"

namespace fieldcast {

class StandbyGroup {
 public:
  // How long a write waits until every member has noted it; lost members do not count.
  static constexpr Duration kNoteLimit = std::chrono::seconds{1};

  struct Handlers {
    std::function<void(const StandbyMessage&)> tell;
    std::function<void(const StandbyNote&)> note;
    std::function<std::vector<StandbyBusFigures>()> figures;
    // Returns true if readers matched or requested missing samples since the last call.
    std::function<bool()> readers_came;
    std::function<void()> changed;  // The role, or the term as master, has changed. Any thread.
    // A note of the master about a command; on the thread that calls on_note().
    std::function<void(const StandbyNote&)> noted;
    // A report of a waiting member about a command without a result; same thread, only as master.
    std::function<void(const StandbyNote&)> held;
  };
  // `own`: see Election. The group sets `lease`, which outlives it. `before`: previous membership.
  StandbyGroup(std::string group, const StandbyMember& own, MasterLease& lease, Handlers handlers,
               const Election::Memory& before = {});
  ~StandbyGroup();
  StandbyGroup(const StandbyGroup&) = delete;
  StandbyGroup& operator=(const StandbyGroup&) = delete;

  void start();
  void end();  // announces the end; no handler is called after it returns

  [[nodiscard]] Election::Memory memory() const;

  // ---- other members, as received from DDS
  void on_member(const StandbyMessage& message);
  void on_lost(const std::string& bridge);
  void on_note(const StandbyNote& note);

  // ---- this bridge
  void set_not_ready(std::string reason);
  void set_configuration(std::string configuration);
  // See Election.
  [[nodiscard]] std::optional<std::string> hand_over(const std::string& successor);
  void released();
  void follows(std::uint64_t sequence);

  // Call before a write is sent to its bus, only as master: the other members note that it begins.
  // `done` is called once, on any thread. If it gets false, the write must not run: not all members
  // have noted it in time, or another bridge has begun it.
  void begin(const std::string& bus, const std::string& requester, std::uint64_t request_id,
             std::function<void(bool noted)> done);
  // A begun write had no effect; the successor runs it.
  void give_back(const std::string& bus, const std::string& requester, std::uint64_t request_id);

  // As a waiting member: reports a command without a result. `begun`: a master has begun it.
  void tell_held(const std::string& bus, const std::string& requester, std::uint64_t request_id,
                 bool begun);
  // As master: reports to a waiting member that a command it holds has its result.
  void tell_completed(const std::string& bus, const std::string& requester,
                      std::uint64_t request_id);

  struct View {
    StandbyRole role = StandbyRole::kWaiting;
    StandbyTerm term = 0;
    std::optional<std::string> master;
    std::string not_ready;
    std::uint64_t terms_begun = 0;    // how often this bridge became master
    std::uint64_t behind = 0;         // SampleBlocks of the master not followed yet
    std::vector<std::string> others;  // live members
  };
  // Last published blocks, if the previous master has released its buses; otherwise `std::nullopt`.
  [[nodiscard]] std::optional<std::vector<StandbyBusFigures>> released_by_other() const;
  [[nodiscard]] View view() const;
  [[nodiscard]] StandbyRole role() const;
  [[nodiscard]] StandbyTerm term() const;  // of this bridge as master

 private:
  struct Waiting {
    StandbyNote note;
    Instant until{};
    std::function<void(bool)> done;
  };
  struct Process {
    std::string identity;
    FileDescriptor handle;  // readable when it has ended
  };
  void run();
  // Passes an input to the election and applies the role that results.
  template <class Input>
  void apply(Input input);
  void give_up_begun(const StandbyNote& note);
  // The next functions REQUIRE: mutex_ held.
  void follow_role();
  [[nodiscard]] StandbyMessage message(Instant now);
  [[nodiscard]] std::vector<std::pair<std::function<void(bool)>, bool>> settle_notes(Instant now);
  [[nodiscard]] std::vector<StandbyNote> notes_again();
  [[nodiscard]] bool noted_by_all(std::uint64_t number, Instant now) const;
  void watch_processes();
  void look_at_processes();
  void wake() const;

  const std::string group_;
  const std::string host_, process_;
  MasterLease& lease_;
  const Handlers handlers_;
  FileDescriptor wake_;

  mutable std::mutex mutex_;
  Election election_;
  std::map<std::string, StandbyMessage> others_;
  std::map<std::string, Process> processes_;
  std::vector<Waiting> waiting_;
  RecentCommands begun_elsewhere_;
  std::uint64_t written_ = 0;  // in the present term, as master
  StandbyTerm noted_term_ = 0;
  std::uint64_t noted_ = 0;  // in the master's term
  std::string own_name_;
  StandbyRole told_ = StandbyRole::kWaiting;
  StandbyTerm told_term_ = 0;
  bool note_again_ = false;
  std::uint64_t terms_begun_ = 0;
  std::optional<std::vector<StandbyBusFigures>> released_;  // by the previous master
  bool beat_soon_ = false;
  bool ending_ = false;
  std::mutex noting_;  // keeps the notes in the order of their numbers
  std::thread thread_;
};

}  // namespace fieldcast
