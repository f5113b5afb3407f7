// What a bridge has because it belongs to a standby group: the thread that changes its role, the
// buses that are prepared, and the commands that are held while another bridge is master. Private
// to Bridge.
#pragma once

#include <atomic>
#include <condition_variable>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "bridge/bus/bus_runner.hpp"
#include "bridge/bus/io_thread.hpp"
#include "bridge/command/recent_commands.hpp"
#include "bridge/publish/bus_output.hpp"
#include "bridge/standby/election.hpp"
#include "bridge/standby/held_commands.hpp"
#include "core/alarm/alarm_status.hpp"
#include "core/model/command.hpp"

namespace fieldcast {

struct RunningBus {
  std::unique_ptr<BusOutput> sink;  // outlives the runner, and what it has posted
  std::unique_ptr<IoThread> io;     // outlives the runner too
  std::shared_ptr<BusRunner> runner;
};

struct Standby {
  struct HeldCommand {
    std::string bus;
    Command command;
  };

  ~Standby() { end(); }

  // True: another bridge is master, and will answer it.
  [[nodiscard]] bool hold(const std::string& bus, const Command& command);
  [[nodiscard]] bool hold(const AlarmAction& action);
  // A command that this bridge was to run has its result.
  void answered();
  // What the group tells of others.
  void seen_answer(const std::string& requester, std::uint64_t request_id);
  // This bridge tells its result.
  void note_result(const std::string& requester, std::uint64_t request_id);
  // Either was a moment ago.
  [[nodiscard]] bool has_result(const std::string& requester, std::uint64_t request_id);

  // The thread of roles: calls `look` when it was notified, and while that says so, soon again.
  void start(std::function<bool()> look);
  void notify();
  // Asks `reached` now and after each notify(), until `limit`; what it said last. No lock is held
  // meanwhile.
  [[nodiscard]] bool wait_until(Instant limit, const std::function<bool()>& reached);
  void linger(Duration time);
  void end();  // a second call has no effect

  // Under Bridge's `changing`.
  bool serving = false;  // the buses of the group run here
  StandbyTerm term = 0;  // in which their samples count
  std::map<std::string, RunningBus, std::less<>> prepared;

  HeldCommands<HeldCommand> commands;
  HeldCommands<AlarmAction> actions;
  std::atomic<int> in_hand{0};  // commands that run here and have no result yet
  std::atomic<bool> handing_over = false;
  Election::Memory remembered;   // of the membership before this one, ..
  std::string remembered_group;  // .. in this group
  std::string shadowed;          // why it must not be master: another one has its name; empty: none
  bool has_namesake = false;     // which is not to be master
  std::string said_not_ready;    // in the log
  std::atomic<bool> leaving = false;       // the bridge stops
  std::atomic<bool> readers_came = false;  // or asked for what they lack
  std::mutex follower_mutex;               // the follower, while it is made or ended
  std::mutex late_mutex;
  // Results that came while the lease did not hold.
  std::vector<std::pair<std::string, CommandResult>> late;

 private:
  void run(const std::function<bool()>& look);
  std::mutex mutex_;
  std::condition_variable changed_;
  std::uint64_t notified_ = 0;
  bool ending_ = false;
  std::thread thread_;
  std::mutex answered_mutex_;
  RecentCommands with_result_{HeldCommands<HeldCommand>::kAnswersFor};
};

}  // namespace fieldcast
