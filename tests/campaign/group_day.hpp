// Simulates a day of a standby group in virtual time: two or three bridges share one wire, which
// they fence by listening. The network between them and a station loses and delays messages and is
// partitioned. Processes are killed, paused and restarted; masters hand over on request; commands
// and new values arrive all the time.
//
// These invariants are checked at every step; the first that fails is the day's violation:
//   - a master never sends while another master sends, and uses the wire only after its silence;
//   - two members are master together only until they receive each other's messages;
//   - the sequence numbers of a channel increase, and no sample of an old master follows one of the
//     new master;
//   - a command has a result, a write never has two that contradict, and it never runs twice;
//   - a good value is what its device contained a moment ago;
//   - while a bridge could serve, channels are read, and no silent channel is shown as good.
// Each check names the violations that a partition excuses. Deterministic by protocol and seed; one
// thread; no clock, no I/O.
#pragma once

#include <deque>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <random>
#include <set>
#include <string>
#include <vector>

#include "core/bus/wire/fence_setup.hpp"
#include "tests/bus/late_storm.hpp"
#include "tests/campaign/group_member.hpp"
#include "tests/campaign/plant_memory.hpp"

namespace fieldcast::test {

struct GroupCounts {
  std::uint64_t frames = 0, garbled = 0, turns = 0;  // of masters; garbled: while two masters begin
  std::uint64_t samples = 0, good = 0;
  std::uint64_t commands = 0, results = 0, executed = 0;
  std::uint64_t second_results = 0;  // FAILED after a first result: docs/redundancy.md
  std::uint64_t kills = 0, stops = 0, hand_overs = 0, cuts = 0, takeovers = 0;
  std::uint64_t violations = 0;
  void add(const GroupCounts& other);
};

// Protocols of lines that several masters can share.
[[nodiscard]] std::vector<StormKind> group_kinds();

class GroupDay {
 public:
  static constexpr std::size_t kTranscriptLines = 2000;  // the last ones are kept

  GroupDay(const StormKind& kind, std::uint64_t seed, Duration length,
           GroupSabotage sabotage = GroupSabotage::kNone);
  ~GroupDay();
  GroupDay(const GroupDay&) = delete;
  GroupDay& operator=(const GroupDay&) = delete;

  void keep_transcript() { transcribing_ = true; }
  // Runs to the end of the day, to its first violation, or until `stop` returns true.
  void run(const std::function<bool()>& stop = {});

  [[nodiscard]] const std::optional<std::string>& violation() const { return violation_; }
  [[nodiscard]] const std::deque<std::string>& transcript() const { return transcript_; }
  [[nodiscard]] GroupCounts counts() const;
  [[nodiscard]] Duration reached() const { return now() - Instant{}; }

 private:
  // State of a channel as the station received it.
  struct Channel {
    DeviceIndex device = 0;
    const ChannelSpec* spec = nullptr;
    Duration gap{};  // promised
    std::uint64_t epoch = 0, sequence = 0;
    Instant master_began{};  // start of the master of the last counted sample
    Instant again_began{};   // start of the master that last repeated its values
    bool shown_good = false;
    Instant published{}, last_good{};
    int below = 0;  // samples with a lower number since the last accepted one
  };
  struct Pending {
    ChannelIndex channel = 0;
    std::optional<Value> written;
    Instant sent{};
    std::vector<CommandResult> results;
  };
  struct Writes {  // of a device
    std::uint64_t sent = 0, refused = 0, excused = 0;
  };

  [[nodiscard]] Instant now() const { return wire_->now(); }
  [[nodiscard]] double chance() { return std::generate_canonical<double, 53>(random_); }
  [[nodiscard]] Duration between(Duration least, Duration most);

  void run_until(Instant until);
  void operate();
  void restart_members();
  void kill();
  void stop_one();
  void hand_over();
  void cut();
  void command();
  void ask_for_samples();
  void tell(std::size_t from, GroupMessage message);
  [[nodiscard]] std::vector<std::size_t> living() const;

  // The checks.
  void see_frame(Instant start, int sender, ByteView bytes);
  void see_action(std::size_t member, const Action& action);
  void judge_values(const GroupBlock& block);
  void see_block(const GroupBlock& block);
  void see_sample(const GroupBlock& block, const Sample& sample);
  void see_result(const CommandResult& result);
  void judge_results(std::uint64_t id, const Pending& pending);
  void judge_masters();
  void judge_writes();
  void sweep();
  [[nodiscard]] bool was_cut_since(Instant when) const;
  void note(const std::string& text);
  void violate(const std::string& what);

  const StormKind kind_;
  std::mt19937_64 random_;
  const Duration length_;
  const GroupSabotage sabotage_;
  BusSpec spec_;
  FenceTimes times_;
  std::unique_ptr<SharedWire> wire_;
  std::unique_ptr<GroupNetwork> network_;
  PlantMemory memory_;
  std::vector<std::unique_ptr<GroupMember>> members_;
  std::vector<Instant> restarts_;  // of each member; kNever: it runs
  bool one_kernel_ = false;        // members notice the end of each other's processes
  Instant heal_at_ = kNever, healed_ = kLongAgo;

  std::vector<Channel> channels_;
  std::map<std::uint64_t, Pending> pending_;
  std::set<std::uint64_t> settled_;  // writes of the last minutes that have their result
  std::uint64_t next_command_ = 1;
  std::vector<Writes> writes_;
  Instant served_since_{}, two_since_ = kNever;
  Instant ask_at_ = kNever;  // time of the station's request for samples
  Duration ask_rest_{};
  int last_master_ = -1;
  Instant wire_until_{}, busy_since_{};
  Instant other_until_{};  // end of the last frame of a different master
  std::uint64_t garbled_ = 0;

  std::optional<GroupBlock> before_;  // of the previous master, for kOldSample
  bool transcribing_ = false;
  GroupCounts counts_;
  std::optional<std::string> violation_;
  std::deque<std::string> transcript_;
};

}  // namespace fieldcast::test
