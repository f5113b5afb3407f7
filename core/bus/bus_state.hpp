// What a BusEngine holds, and its parts: events, decisions and exchanges (bus_engine.cpp), devices
// (bus_devices.cpp), reading (bus_reads.cpp), reporting (bus_report.cpp). Private to core/bus.
#pragma once

#include <deque>
#include <optional>
#include <vector>

#include "core/bus/action_sink.hpp"
#include "core/bus/bus_engine.hpp"
#include "core/bus/channel_table.hpp"
#include "core/bus/command_queue.hpp"
#include "core/bus/device_monitor.hpp"
#include "core/bus/device_state.hpp"
#include "core/bus/exchange_driver.hpp"
#include "core/bus/late_answers.hpp"
#include "core/bus/overload_watch.hpp"
#include "core/bus/wire_load.hpp"
#include "core/schedule/planned_times.hpp"
#include "core/schedule/point_map.hpp"
#include "core/schedule/scheduler.hpp"

namespace fieldcast {

struct BusEngine::State {
  static constexpr Duration kForgetRefused =
      std::chrono::minutes{1};  // then a refused address is tried again
  static constexpr Duration kShortWait =
      std::chrono::milliseconds{20};  // that the wire rests for a command already begun
  static constexpr std::size_t kMaxRefusedListed = 64;
  static constexpr Duration kLongestStray =
      std::chrono::milliseconds{300};   // a line that babbles longer is used all the same
  static constexpr int kMostHeld = 32;  // reads put off in one decision

  // The exchange on the wire, or about to be sent again.
  struct Flight {
    enum class Kind : std::uint8_t { kRead, kCommand, kProbe };
    Kind kind = Kind::kRead;
    DeviceIndex device = 0;
    Request request;
    Block block;  // kRead
    Instant started{};
    unsigned tries = 0;
    bool timed_out = false;     // an earlier try went unanswered: what comes may be its answer
    ExchangeContext context{};  // of the last try
    bool waiting = false;       // for the wire to be free, to be sent again
    Duration timeout{};
    Duration rest{};        // since the device's last answer, when it was sent
    bool longer = false;    // kRead: than its block, to be told apart from what is owed
    std::size_t batch = 1;  // kCommand: how many commands, from the first on, the request carries
  };
  struct Held {
    Block block;
    Instant until{};
  };

  State(const BusSpec& bus, TextCodec& codec);

  // bus_engine.cpp
  void settle(Instant now, Actions& actions);
  void decide(Instant now, Actions& actions);
  void ask_for_plan(Actions& actions);
  void launch(Flight flight, Instant now, Actions& actions);
  void transmit(Instant now, Actions& actions);
  void advance(ExchangeDriver::Outcome outcome, Bytes&& out, Instant now, Actions& actions);
  void conclude(bool done, Instant now, Actions& actions);
  [[nodiscard]] bool try_again(const Flight& flight, Cause cause) const;
  void opened(Instant now);
  void closed(const Closed& why, Instant now, Actions& actions);
  void begin_lease(Instant now, Actions& actions);
  void expire_channels(Instant now, Actions& actions);
  void set_interest(ChannelIndex channel, std::optional<Duration> wish, Instant now,
                    Actions& actions);

  // late answers
  [[nodiscard]] Instant askable_from(const Flight& next) const;
  [[nodiscard]] bool make_distinct(Flight& read, Instant now) const;
  void settle_debts_of(const Flight& flight, bool answered, bool refused, Instant now);
  void owe_flight_under_way();
  [[nodiscard]] std::vector<LateAnswers::Late> late_in_exchange(Instant now);
  void take_late(std::vector<LateAnswers::Late> answers, Instant now, Actions& actions);
  void heard_stray(ByteView bytes, Instant now, Actions& actions);
  [[nodiscard]] bool is_another_answer() const;
  void hold(const Block& block, Instant until, Instant now);
  void release_held(Instant now);

  // devices
  void device_failed(const Flight& ended, Cause cause, Duration spent, Instant now,
                     ActionSink& sink);
  void rest_device(DeviceIndex device, Instant now);
  [[nodiscard]] std::optional<Flight> probe_due(Instant now);
  [[nodiscard]] std::vector<std::optional<Range>> probed() const;

  // bus_reads.cpp
  void make_scheduler();
  void block_read(const Flight& flight, const Reply& reply, Instant acquired, Instant now,
                  Actions& actions);
  void learn_blocks(const Flight& read, const Reply& reply, Instant now);
  void block_failed(const Flight& flight, Cause cause, std::uint16_t code, Instant now,
                    Actions& actions);
  void block_refused(const Block& block, Cause cause, std::uint16_t code, Instant now,
                     std::vector<Sample>& out, ActionSink& sink);
  [[nodiscard]] std::string point_text(PointIndex point) const;
  void update_point(PointIndex point, Instant now);

  // commands
  [[nodiscard]] CommandQueue::Gate gate() const {
    return [this](const CommandJob& job) { return command_from(job); };
  }
  [[nodiscard]] Instant command_from(const CommandJob& job) const;

  BusSetup setup;
  const BusSpec& spec;
  const LineFormat& line;
  Duration silence;
  std::vector<DeviceRuntime> devices;
  TextCodec& codec;
  ChannelTable channels;
  CommandQueue commands;

  PointMap map;
  std::unique_ptr<Scheduler> scheduler;
  PlannedTimes planned_times;  // what the scheduler takes for answer times
  std::optional<DeviceMonitor> monitor;

  ExchangeDriver driver;
  LateAnswers late;
  std::vector<Held> held;         // reads that wait until an answer that is owed has come
  Instant strays_since = kNever;  // while they keep the wire from being free
  std::optional<Flight> flight;
  bool command_was_last = false;  // then a read that is due goes first
  BusState bus_state = BusState::kOpening;
  Cause closed_because = Cause::kNone;  // while it is closed
  Instant free_at = kLongAgo;           // the wire must be silent until then
  Instant rest_until = kLongAgo;
  Instant timer = kNever;  // as last told to the shell
  bool begun = false;
  bool trace = false;
  std::optional<OverloadWatch> overload;

  // reporting
  std::uint64_t exchanges = 0, samples = 0, reopened = 0;
  CauseCounters causes;
  WireLoad load;
};

}  // namespace fieldcast
