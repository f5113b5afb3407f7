// The way of reads: from the channels of a bus to the next read, and from its answer to samples.
//
// Owns the scheduler, the map from points to channels, the reads that are held back while their
// answer could be mistaken, and what refusals taught about each device's addresses. Owned by the
// bus engine, on the bus's thread. What can fail: a device refuses addresses; they are searched
// for, told in a notice and in their samples, left alone for kForgetRefused, then tried again. An
// address that was read before is asked once more at once: the line may have garbled the request.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <variant>
#include <vector>

#include "core/bus/action_sink.hpp"
#include "core/bus/block_learning.hpp"
#include "core/bus/bus_setup.hpp"
#include "core/bus/channel_table.hpp"
#include "core/dispatch/scheduler.hpp"
#include "core/model/status.hpp"
#include "core/plan/plan_report.hpp"
#include "core/schedule/planned_times.hpp"
#include "core/schedule/point_map.hpp"

namespace fieldcast {

class ReadPath {
 public:
  static constexpr Duration kForgetRefused = std::chrono::minutes{1};
  static constexpr int kMaxHeldAtOnce = 32;             // reads held back in one call of next()
  static constexpr std::size_t kMaxRefusedListed = 64;  // addresses in a report, and gaps
  // Items that a read is made longer by, at most, as a multiple of the area's alignment.
  static constexpr std::uint32_t kMostLonger = 4;

  // After an answer that the device cannot read a block at the moment. The pause doubles with each
  // such answer, up to the shortest refresh in the block.
  static constexpr Duration kFirstBusyPause = std::chrono::milliseconds{100};
  static constexpr Duration kLongestBusyPause = std::chrono::seconds{30};
  // So many such answers to a block, while the device answers other requests, start the search for
  // the address that causes them. It is then requested alone.
  static constexpr unsigned kBusyToSearch = 3;

  // A read for the wire. `longer`: the request asks for more items than the block needs, so that
  // its answer differs from those that are owed.
  struct Read {
    Block block;
    Request request;
    bool longer = false;
  };
  // From when on a read of a device may be sent, as far as late answers are concerned.
  using Gate = std::function<Instant(DeviceIndex, const Request&)>;

  // setup and channels outlive this.
  ReadPath(const BusSetup& setup, ChannelTable& channels);

  // What to read now, or until when to rest. REQUIRES: the wire is free.
  [[nodiscard]] std::variant<Read, Rest> next(Instant now, const Gate& gate);
  // Whether some read is due. REQUIRES: the wire is free.
  [[nodiscard]] bool due(Instant now);
  // Debts have ended: reads that were held back for them are due.
  void release_held(Instant now, const Gate& gate);

  // A block was answered. `acquired`: arrival of the answer.
  void answered(const Block& block, const Reply& reply, Instant acquired, Instant now,
                ActionSink& sink);
  // An answer began `answer_time` after the end of its request.
  void learn(DeviceIndex device, AreaIndex area, Duration answer_time);
  // Another bridge has read the channel last at `acquired`. REQUIRES: nothing was read yet.
  void inherit(ChannelIndex channel, Instant acquired);
  // What another bridge has learned: answer times, the longest blocks, refused addresses.
  void inherit(DeviceIndex device, const DeviceReport& learned, Instant now);
  // The read of a block failed. `longer`: as in Read.
  void failed(const Block& block, bool longer, Cause cause, std::uint16_t code, Instant now,
              ActionSink& sink);
  // The device answered a probe: what it cannot read at the moment concerns single blocks.
  void probe_answered(DeviceIndex device) { others_answered(device); }
  // A block was given up from outside; it is due again.
  void broken_off(const Block& block, Instant now) { scheduler_->failed(block, now, now); }

  // Another device may be there when this one comes back.
  void forget(DeviceIndex device);
  // No reads of the device before `until`.
  void suspend(DeviceIndex device, Instant until) { scheduler_->suspend(device, until); }
  // The shortest refresh that stations want of a channel, or the end of all interest in it.
  void set_interest(ChannelIndex channel, std::optional<Duration> refresh, Instant now,
                    ActionSink& sink);

  // How long the wire may be blocked from now on without making a read late.
  [[nodiscard]] Duration slack(Instant now) { return scheduler_->slack(now); }
  [[nodiscard]] double planned_load() const { return scheduler_->planned_load(); }
  [[nodiscard]] double stretch() const { return scheduler_->stretch(); }
  // A draft of another plan, if one may be worth it. It needs nothing of this object.
  [[nodiscard]] std::shared_ptr<PlanDraft> draft();
  void adopt(PlanDraft& draft, Instant now) {
    scheduler_->adopt(draft, now);
    ++plan_number_;
  }
  // Counts the plans that were in force, from 1; and the present one, for people.
  [[nodiscard]] std::uint64_t plan_number() const { return plan_number_; }
  [[nodiscard]] PlanReport plan_report() const;

  // "oil-temperature, running, +3": what a block reads, `most` of them by name.
  [[nodiscard]] std::string channel_names(const Block& block, std::size_t most) const;
  // The first range of each device, nothing for a device without any.
  [[nodiscard]] std::vector<std::optional<Range>> first_ranges() const;
  // Adds what was learned of the device's blocks and addresses. REQUIRES: report.areas has its
  // areas.
  void describe(DeviceIndex device, DeviceReport& report) const;

 private:
  struct Held {
    Block block;
    Instant until{};
  };
  // A block that the device cannot read at the moment.
  struct Busy {
    Duration pause{};  // the last one
    unsigned times = 0;
    bool others_answered = false;  // the device answered another request since the first time
  };
  // Of one device.
  struct Learned {
    std::vector<BlockLearning> areas;
    bool refused_longer = false;                  // reads are not made longer any more
    std::map<PointIndex, std::uint16_t> refused;  // points refused now, with the device's code
    std::set<PointIndex> doubted;                 // points whose refusal was not believed at once
    std::map<PointIndex, Busy> busy;              // by the first point of the block
    std::set<PointIndex> searched;    // points of blocks that are searched for a busy address
    std::set<PointIndex> busy_alone;  // what was found: points that are requested alone
  };
  // Points of a block that one answer refused.
  struct RefusedPart {
    std::size_t range = 0;  // index in the block's ranges
    std::vector<PointIndex> points;
  };
  [[nodiscard]] bool lengthen(Read& read, Instant now, const Gate& gate) const;
  void hold(const Block& block, Instant until, Instant now);
  void learn_blocks(const Block& block, const Reply& reply, Instant now);
  void accept(PointIndex point, const Range& answered, ByteView items, Instant acquired,
              std::vector<Sample>& samples, ActionSink& sink);
  void refused(const Block& block, Cause cause, std::uint16_t code, Instant now,
               std::vector<Sample>& samples, ActionSink& sink);
  // The device cannot read the block at the moment: it is requested again after a pause.
  void busy(const Block& block, std::uint16_t code, Instant now, ActionSink& sink);
  void others_answered(DeviceIndex device);
  // Whether a refusal of these points is to be heard a second time before it is believed.
  [[nodiscard]] bool doubts(const Block& block);
  void point_refused(PointIndex point, Cause cause, std::uint16_t code, Instant now,
                     std::vector<Sample>& samples, ActionSink& sink);
  void update_point(PointIndex point, Instant now);
  [[nodiscard]] const std::string& text(PointIndex point) const;

  const BusSetup& setup_;
  ChannelTable& channels_;
  PointMap map_;
  std::unique_ptr<Scheduler> scheduler_;
  std::uint64_t plan_number_ = 1;
  PlannedTimes planned_times_;  // what the scheduler takes for answer times
  std::vector<Learned> learned_;
  std::vector<Held> held_;
};

}  // namespace fieldcast
