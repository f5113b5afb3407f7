// Simulates a bridge of a standby group in virtual time: its election, its engine, the master's
// data that it follows, held commands, and notes of writes that begin. It mirrors the shell
// (bridge/role/membership.cpp, bridge/standby/standby_group.cpp, bridge/publish/bus_output.cpp)
// without its threads, with the same Election, HeldCommands, CommandLedger and BusEngine.
//
// Deterministic by its seed; one thread; no function fails.
#pragma once

#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <random>
#include <string>
#include <vector>

#include "bridge/publish/publisher_thread.hpp"
#include "bridge/standby/election.hpp"
#include "bridge/standby/held_commands.hpp"
#include "bridge/standby/standby_values.hpp"
#include "core/bus/command/command_ledger.hpp"
#include "tests/bus/shared_wire.hpp"
#include "tests/campaign/group_network.hpp"

namespace fieldcast::test {

// Fault that a test injects to show that the checks find it.
enum class GroupSabotage : std::uint8_t {
  kNone,
  kDeaf,        // masters do not listen to the wire
  kOldSample,   // a replaced master publishes once more
  kSequences,   // a new master restarts its sequence numbers
  kTwoRuns,     // a new master runs commands that the old one began
  kNoResult,    // a result is dropped
  kTwoResults,  // a result arrives twice
  kValue,       // a good sample has a wrong value
  kSilence,     // a new master drops the samples of a channel
  kTwoMasters,  // a master does not step back
};

class GroupMember {
 public:
  struct Outside {
    SharedWire& wire;
    std::function<void(GroupMessage)> tell;  // the other members, and the station
    std::function<void()> joined;            // as a waiting member
    std::function<void(const std::string&)> note;
    GroupSabotage sabotage = GroupSabotage::kNone;
  };
  GroupMember(std::size_t index, std::int32_t strength, const BusSpec& spec, Outside outside,
              std::uint64_t seed);

  // ---- events of its process
  void start(Instant now);
  void kill();
  void stop(Duration time, Instant now);  // pauses the process for `time`
  // Reports that the process of member `name` has ended.
  void lost(const std::string& name);
  // Requests a hand-over to a different master. Returns false if refused.
  bool hand_over(Instant now);

  void receive(const GroupMessage& message, Instant now);
  void on_action(const Action& action, Instant now);
  void on_time(Instant now);
  [[nodiscard]] Instant next_due() const;
  // Publishes the last values again, as for a new reader. Only for a master.
  void publish_again(Instant now);
  // As publish_again(), for a new reader or for one that requests missing samples.
  void readers_came(Instant now);

  [[nodiscard]] const std::string& name() const { return name_; }
  [[nodiscard]] bool alive() const { return alive_; }
  [[nodiscard]] bool may_send(Instant now) const;
  [[nodiscard]] bool serving() const { return serving_; }
  [[nodiscard]] Instant promoted() const { return serving_ ? promoted_ : kLongAgo; }
  // Epoch of the published catalogue; 0: none.
  [[nodiscard]] std::uint64_t epoch() const { return alive_ && serving_ ? followed_.epoch : 0; }
  [[nodiscard]] StandbyTerm term() const { return election_ ? election_->term() : 0; }
  // Start of the time in which it could be master; kNever: it cannot.
  [[nodiscard]] Instant fit_since() const { return fit_since_; }
  // End of the last pause of its process.
  [[nodiscard]] Instant stopped_until() const { return stopped_until_; }
  [[nodiscard]] std::uint64_t takeovers() const { return takeovers_; }

 private:
  struct Waiting {
    std::uint64_t number;
    Instant until;
    Command command;
  };
  struct Followed {
    std::uint64_t epoch = 0, blocks = 0;
    std::vector<Sample> samples;
    std::map<std::string, DeviceReport> devices;
  };
  using Key = HeldCommands<Command>::Key;

  void join(Instant now);
  void follow_role(Instant now);
  void promote(Instant now);
  void run_held(Instant now);
  void finish_begun(Instant now);
  void release(Instant now);
  void leave(Instant now);
  void let_go_of_the_bus();

  void run(Command command, Instant now);
  void begin(Command command, Instant now);
  void settle_notes(Instant now);
  [[nodiscard]] bool noted_by_all(std::uint64_t number, Instant now) const;
  void tell_note(StandbyNoteKind kind, const Key& key, std::uint64_t number);
  bool completed_elsewhere(const Key& key, Instant now);
  void seen_result(const Key& key, Instant now);
  void tell_held(Instant now);
  void tell_last_words(Instant now);
  void resolve_unknown(const StandbyNote& held, Instant now);
  void refuse(const Command& command, Cause cause, Instant now);
  [[nodiscard]] static CommandResult unfinished(const Key& key, bool begun);
  void answer(const CommandResult& result, Instant now);
  void complete(const CommandResult& result, Instant now);

  void publish(std::vector<Sample> samples, Instant now);
  void remain_master(Instant now);
  void follow(const GroupBlock& block);
  void on_note(const StandbyNote& note, Instant now);
  void give_up_begun(const StandbyNote& note, Instant now);
  [[nodiscard]] StandbyMessage message(Instant now);
  void note(const std::string& text) const { outside_.note(name_ + " " + text); }
  [[nodiscard]] Duration between(Duration least, Duration most);

  const std::size_t index_;
  const std::string name_;
  const std::int32_t strength_;
  const BusSpec& spec_;
  const Outside outside_;
  std::mt19937_64 random_;

  bool alive_ = false;
  Instant stopped_until_ = kLongAgo;
  std::vector<GroupMessage> inbox_;  // while its process is paused
  Instant joins_at_ = kNever, ready_at_ = kNever, fit_since_ = kNever;
  std::optional<Election> election_;
  Election::Memory remembered_;  // of its previous membership
  std::unique_ptr<HeldCommands<Command>> held_;
  std::unique_ptr<CommandLedger> ledger_;
  RecentCommands elsewhere_;
  RecentCommands begun_elsewhere_;
  RecentCommands with_result_;

  // The group.
  std::map<std::string, StandbyMessage> others_;
  StandbyRole told_ = StandbyRole::kWaiting;
  std::optional<StandbyBusFigures> released_;  // by the previous master
  Instant next_tick_{}, next_beat_{}, next_look_{};
  bool beat_soon_ = false;
  std::uint64_t written_ = 0, noted_ = 0;
  StandbyTerm noted_term_ = 0;
  std::vector<Waiting> waiting_;

  // The bus.
  bool serving_ = false, handing_over_ = false;
  StandbyTerm counted_ = 0;  // term in which it counts its samples
  Instant counted_since_{};
  Instant promoted_{}, promote_by_ = kNever, give_up_at_ = kNever, release_by_ = kNever,
                       leave_at_ = kNever;
  Followed followed_;  // as a waiting member; a master: its published data
  std::uint64_t in_hand_ = 0;
  std::vector<CommandResult> late_;
  std::unique_ptr<SampleHold> hold_;
  Instant next_report_{};
  std::uint64_t takeovers_ = 0;
};

}  // namespace fieldcast::test
