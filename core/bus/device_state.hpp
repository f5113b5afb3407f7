// One device of a bus at run time. Plain state; the engine's parts read and change it.
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "core/bus/answer_time.hpp"
#include "core/bus/block_learning.hpp"
#include "core/bus/device_health.hpp"
#include "core/bus/garbage.hpp"
#include "core/bus/pause_learning.hpp"
#include "core/model/spec.hpp"
#include "core/protocol/protocol.hpp"
#include "core/schedule/scheduler.hpp"

namespace fieldcast {

// What was learned of one area of a device.
struct AreaLearning {
  AnswerTime answer_time;
  BlockLearning blocks;
};

struct DeviceRuntime {
  const DeviceSpec* spec = nullptr;
  const Protocol* protocol = nullptr;
  AnswerTime answer_time;
  std::vector<AreaLearning> areas{};  // as the protocol has them
  PauseLearning pauses{};
  Instant answered_at = kLongAgo;  // its last answer
  DeviceHealth health;
  Garbage garbage;
  bool refused_longer = false;      // a read longer than its block: not tried again
  Instant paused_until = kLongAgo;  // the device wants a rest
  double failure_share = 0;         // of its last tries, 0..1
  Instant deferred_until =
      kLongAgo;  // a sick device waits until the wire has time for it, at the latest until then
  Duration wasted{};                            // wire time of its last failure
  Instant probe_not_before = kLongAgo;          // the wire had no time for a probe
  bool resting = false;                         // the scheduler was told to leave it alone
  std::map<PointIndex, std::uint16_t> refused;  // points refused at present, with the device's code
  std::uint64_t exchanges = 0, failures = 0, retries = 0;
  CauseCounters causes;

  void tried(bool well) { failure_share += ((well ? 0.0 : 1.0) - failure_share) / 8; }
  [[nodiscard]] bool sick() const { return failure_share > 0.2; }
};

}  // namespace fieldcast
