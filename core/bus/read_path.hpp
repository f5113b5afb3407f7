// Selects the next read of a bus and turns its response into samples. Owns the scheduler, the map
// from points to channels, reads held back for pending responses, and the refused addresses of each
// device. Refused addresses are isolated, reported in a notice and in their samples, and not read
// for kForgetRefused. An address that was read before is requested again immediately, as noise may
// have changed the request. Owned by the bus engine, on the bus's thread.
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

#include "core/bus/command/channel_table.hpp"
#include "core/bus/health/learning.hpp"
#include "core/bus/setup/bus_setup.hpp"
#include "core/dispatch/scheduler.hpp"
#include "core/model/status.hpp"
#include "core/plan/read_plan.hpp"
#include "core/schedule/bus_schedule.hpp"
#include "core/schedule/planned_times.hpp"

namespace fieldcast {

class ReadPath {
 public:
  static constexpr Duration kForgetRefused = std::chrono::minutes{1};
  static constexpr int kMaxHeldAtOnce = 32;             // reads held back in one call of next()
  static constexpr std::size_t kMaxRefusedListed = 64;  // addresses and gaps in a report
  // Maximum lengthening of a read, as a multiple of the area's alignment.
  static constexpr std::uint32_t kMostLonger = 4;

  // Pause after a busy response. It doubles each time, up to the block's shortest refresh.
  static constexpr Duration kFirstBusyPause = std::chrono::milliseconds{100};
  static constexpr Duration kLongestBusyPause = std::chrono::seconds{30};
  // So many such responses to a block, while the device responds to other requests, start the
  // search for the address that causes them. It is then requested alone.
  static constexpr unsigned kBusyToSearch = 3;

  // `longer`: requests more items than needed, to distinguish its response from pending ones.
  struct Read {
    Block block;
    Request request;
    bool longer = false;
  };
  // Earliest time for a read of a device with respect to pending responses.
  using Gate = std::function<Instant(DeviceIndex, const Request&)>;

  ReadPath(const BusSetup& setup, ChannelTable& channels);

  // The next read, or the time to rest until. REQUIRES: the wire is free.
  [[nodiscard]] std::variant<Read, Rest> next(Instant now, const Gate& gate);
  // REQUIRES: the wire is free.
  [[nodiscard]] bool due(Instant now);
  // Debts have ended: releases the reads held back for them.
  void release_held(Instant now, const Gate& gate);

  // Other reads follow before the response: the block is due again as if it were read now.
  void launched(const Block& block, Instant now) { scheduler_->launched(block, now); }
  void responded(const Block& block, const Reply& reply, Instant acquired, Instant now,
                 ActionSink& sink);
  void learn(DeviceIndex device, AreaIndex area, Duration response_time);
  void save_silence(Duration saved);  // see PlannedTimes::save()
  // Another bridge last read the channel at `acquired`. REQUIRES: no read yet.
  void inherit(ChannelIndex channel, Instant acquired);
  void inherit(DeviceIndex device, const DeviceReport& learned, Instant now);
  void failed(const Block& block, bool longer, Cause cause, std::uint16_t code, Instant now,
              ActionSink& sink);
  // The device responded to a probe: what it cannot read at the moment concerns single blocks.
  void probe_responded(DeviceIndex device) { others_responded(device); }
  // A block was given up from outside; it is due again.
  void broken_off(const Block& block, Instant now) { scheduler_->failed(block, now, now); }

  void forget(DeviceIndex device);
  void suspend(DeviceIndex device, Instant until) { scheduler_->suspend(device, until); }
  // `refresh`: shortest of all stations; empty if all interest ended.
  void set_interest(ChannelIndex channel, std::optional<Duration> refresh, Instant now,
                    ActionSink& sink);

  // How long the wire may be blocked from now on without delaying a read.
  [[nodiscard]] Duration slack(Instant now) { return scheduler_->slack(now); }
  // Whether the next reads are in time after the wire was used otherwise for `use`.
  [[nodiscard]] bool has_headroom(Instant now, Duration use) {
    return scheduler_->has_headroom(now, use);
  }
  [[nodiscard]] double planned_load() const { return scheduler_->planned_load(); }
  [[nodiscard]] double stretch() const { return scheduler_->stretch(); }
  // The draft does not use this object.
  [[nodiscard]] std::shared_ptr<PlanDraft> draft();
  void adopt(PlanDraft& draft, Instant now) {
    scheduler_->adopt(draft, now);
    ++plan_number_;
  }
  [[nodiscard]] std::uint64_t plan_number() const { return plan_number_; }
  [[nodiscard]] PlanReport plan_report() const;

  // Channel names of a block, at most `most`: "oil-temperature, running, +3".
  [[nodiscard]] std::string channel_names(const Block& block, std::size_t most) const;
  // First range by device; empty for a device without ranges.
  [[nodiscard]] std::vector<std::optional<Range>> first_ranges() const;
  // REQUIRES: report.areas has the device's areas.
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
    bool others_responded =
        false;  // the device responded to a different request since the first time
  };
  struct Learned {
    std::vector<BlockLearning> areas;
    bool refused_longer = false;                  // reads are not made longer any more
    std::map<PointIndex, std::uint16_t> refused;  // points refused now, with the device's code
    std::set<PointIndex> doubted;     // points whose refusal was not accepted immediately
    std::map<PointIndex, Busy> busy;  // by the first point of the block
    std::set<PointIndex> searched;    // points of blocks that are searched for a busy address
    std::set<PointIndex> busy_alone;  // what was found: points that are requested alone
  };
  struct RefusedPart {
    std::size_t range = 0;  // index in the block's ranges
    std::vector<PointIndex> points;
  };
  [[nodiscard]] bool lengthen(Read& read, Instant now, const Gate& gate) const;
  void hold(const Block& block, Instant until, Instant now);
  void learn_blocks(const Block& block, const Reply& reply, Instant now);
  void accept(PointIndex point, const Range& responded, const RangeReply& reply, Instant acquired,
              std::vector<Sample>& samples, ActionSink& sink);
  void refused(const Block& block, Cause cause, std::uint16_t code, Instant now,
               std::vector<Sample>& samples, ActionSink& sink);
  // The device cannot read the block at the moment: it is requested again after a pause.
  void busy(const Block& block, std::uint16_t code, Instant now, ActionSink& sink);
  void others_responded(DeviceIndex device);
  // Returns true if a second refusal of these points is needed before the first one counts.
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
  PlannedTimes planned_times_;  // response times assumed by the scheduler
  std::vector<Learned> learned_;
  std::vector<Held> held_;
};

}  // namespace fieldcast
