// Parts of a bridge in a standby group: the thread that changes its role, the prepared buses, and
// the commands held while another bridge is master. Private to Bridge.
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

#include "bridge/base/io_thread.hpp"
#include "bridge/bus/bus_runner.hpp"
#include "bridge/publish/bus_output.hpp"
#include "bridge/standby/election.hpp"
#include "bridge/standby/held_commands.hpp"
#include "bridge/standby/standby_values.hpp"
#include "core/alarm/alarm_status.hpp"
#include "core/model/command.hpp"

namespace fieldcast {

struct RunningBus {
  std::unique_ptr<BusOutput> sink;  // outlives the runner and its posted tasks
  std::unique_ptr<IoThread> io;     // outlives the runner
  std::shared_ptr<BusRunner> runner;
};

struct Standby {
  struct HeldCommand {
    std::string bus;
    Command command;
  };

  ~Standby() { end(); }

  // Returns true if another bridge is master and will respond to the command.
  [[nodiscard]] bool hold(const std::string& bus, const Command& command);
  [[nodiscard]] bool hold(const AlarmAction& action);
  // To be called when a command that this bridge runs has its result.
  void answered();
  // To be called for each response of another bridge that the group reports.
  void seen_answer(const std::string& requester, std::uint64_t request_id);
  // To be called when this bridge publishes a result.
  void note_result(const std::string& requester, std::uint64_t request_id);
  // Returns true if seen_answer() or note_result() was called for this request recently.
  [[nodiscard]] bool has_result(const std::string& requester, std::uint64_t request_id);

  // Starts the thread of roles: calls `look` after each notify(), and again while it returns true.
  void start(std::function<bool()> look);
  void notify();
  // Calls `reached` now and after each notify(), until it returns true or `limit` passes; returns
  // its last value. No lock is held during the call.
  [[nodiscard]] bool wait_until(Instant limit, const std::function<bool()>& reached);
  void linger(Duration time);
  void end();  // may be called twice

  // Guarded by Bridge's `changing`.
  bool serving = false;  // the buses of the group run here
  StandbyTerm term = 0;  // the term of the samples of these buses
  std::map<std::string, RunningBus, std::less<>> prepared;

  HeldCommands<HeldCommand> commands;
  HeldCommands<AlarmAction> actions;
  std::atomic<int> in_hand{0};  // commands that run here and have no result yet
  std::atomic<bool> handing_over = false;
  Election::Memory remembered;   // of the previous membership ..
  std::string remembered_group;  // .. in this group
  // Why it must not become master: a bridge of the same name was first; empty if none.
  std::string shadowed;
  bool has_namesake = false;   // a bridge of the same name exists, which must not become master
  std::string said_not_ready;  // the last reason in the log
  std::atomic<bool> leaving = false;
  std::atomic<bool> readers_came = false;  // readers matched or requested missing data
  std::mutex follower_mutex;               // guards the creation and the end of the follower
  std::mutex late_mutex;
  // Results that arrived while the lease was not held.
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
