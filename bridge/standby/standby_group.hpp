// This bridge as a member of its standby group: runs the election (election.hpp) on a thread of its
// own, which does nothing else, tells the others ten times a second what it is, and watches the
// processes of members under the same kernel. Tells the group which writes begin.
//
// Functions may be called from any thread. Handlers come on the group's thread but where said
// otherwise; none of them may block.
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
#include "bridge/command/recent_commands.hpp"
#include "bridge/standby/master_lease.hpp"
#include "bridge/standby/standby_values.hpp"

namespace fieldcast {

class StandbyGroup {
 public:
  // How long a write waits until every member has noted that it begins; members that are gone
  // meanwhile are not waited for.
  static constexpr Duration kNoteLimit = std::chrono::seconds{1};

  struct Handlers {
    std::function<void(const StandbyMessage&)> tell;
    std::function<void(const StandbyNote&)> note;
    std::function<std::vector<StandbyBusFigures>()> figures;
    // Whether readers of samples have come, or asked for what they lack, since it was last called.
    std::function<bool()> readers_came;
    std::function<void()> changed;  // the role, or the term as master, is another one; any thread
    // What the master tells of a command; on the caller's thread of on_note().
    std::function<void(const StandbyNote&)> noted;
    // What a waiting member tells the master of a command without a result; likewise, and only
    // while this bridge is master.
    std::function<void(const StandbyNote&)> held;
  };
  // `own`: as for Election. `lease` is kept by the group from here on; it outlives it.
  // `before`: of the membership before this one, in the same process.
  StandbyGroup(std::string group, const StandbyMember& own, MasterLease& lease, Handlers handlers,
               const Election::Memory& before = {});
  ~StandbyGroup();  // end()
  StandbyGroup(const StandbyGroup&) = delete;
  StandbyGroup& operator=(const StandbyGroup&) = delete;

  void start();
  void end();  // says that it leaves; no handler is called any more when it returns

  [[nodiscard]] Election::Memory memory() const;

  // ---- the others, as DDS hears them
  void on_member(const StandbyMessage& message);
  void on_lost(const std::string& bridge);
  void on_note(const StandbyNote& note);

  // ---- this bridge
  void set_not_ready(std::string reason);
  void set_configuration(std::string configuration);
  // As in Election.
  [[nodiscard]] std::optional<std::string> hand_over(const std::string& successor);
  void released();
  void follows(std::uint64_t sequence);

  // Before a write goes to its bus: the others note that it begins. `done` is called once, on any
  // thread; false: not all have noted it in time, or another one has begun it, and it must not run.
  // Only as master.
  void begin(const std::string& bus, const std::string& requester, std::uint64_t request_id,
             std::function<void(bool noted)> done);
  // A write that was begun had no effect: the successor runs it.
  void give_back(const std::string& bus, const std::string& requester, std::uint64_t request_id);

  // As a waiting member: the master is told that this command has no result; `begun`: by a master.
  void tell_held(const std::string& bus, const std::string& requester, std::uint64_t request_id,
                 bool begun);
  // As master: a waiting member holds this command, which has its result.
  void tell_answered(const std::string& bus, const std::string& requester,
                     std::uint64_t request_id);

  struct View {
    StandbyRole role = StandbyRole::kWaiting;
    StandbyTerm term = 0;
    std::string group;
    std::optional<std::string> master;
    std::string not_ready;
    std::int32_t strength = 0;
    std::uint64_t terms_begun = 0;    // times that this bridge became master
    std::uint64_t behind = 0;         // SampleBlocks of the master that have not been followed
    std::vector<std::string> others;  // alive
  };
  // The master before this one had let go in order: up to where it had published. Nothing: it is
  // just gone.
  [[nodiscard]] std::optional<std::vector<StandbyBusFigures>> released_by_other() const;
  [[nodiscard]] View view() const;
  [[nodiscard]] StandbyRole role() const;
  [[nodiscard]] StandbyTerm term() const;  // of this bridge, while it is master

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
  void give_up_begun(const StandbyNote& note);
  // REQUIRES for those that follow: mutex_ held.
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
  std::uint64_t written_ = 0;  // of the present term, as master
  StandbyTerm noted_term_ = 0;
  std::uint64_t noted_ = 0;  // of the master's term
  std::int32_t strength_ = 0;
  std::string own_name_;
  StandbyRole told_ = StandbyRole::kWaiting;
  StandbyTerm told_term_ = 0;
  bool note_again_ = false;
  std::uint64_t terms_begun_ = 0;
  std::optional<std::vector<StandbyBusFigures>> released_;  // by the master before
  bool beat_soon_ = false;
  bool ending_ = false;
  std::mutex noting_;  // notes leave in the order of their numbers
  std::thread thread_;
};

}  // namespace fieldcast
