// The devices of a bus: there or not, sick or well, and when each may be asked.
#include <algorithm>
#include <optional>

#include "core/bus/bus_state.hpp"

namespace fieldcast {

void BusEngine::State::device_answered(DeviceIndex index, Actions& actions) {
  DeviceRuntime& device = devices[index];
  const DeviceState before = device.health.state();
  if (!device.health.answered()) return;
  if (before == DeviceState::kOffline) {
    notice(Notice::Kind::kDeviceBack, index, Cause::kNone, "answers again", actions);
  }
}

void BusEngine::State::learn_answer_time(DeviceIndex index, const Request& request) {
  DeviceRuntime& device = devices[index];
  const Duration measured = driver.answer_time();
  device.answer_time.learn(measured);
  if (!std::holds_alternative<ReadRequest>(request)) return;  // writing takes a time of its own
  const AreaIndex area = area_of(request);
  device.areas[area].answer_time.learn(measured);
  planned_times.answered(index, area, measured, *scheduler);
}

// What was learned shortens the wait only for reads that can be asked again, and whose late answers
// show whose they are: the bus goes on meanwhile, and they still count.
Duration BusEngine::State::timeout_for(const DeviceRuntime& device, const Flight& asked) const {
  if (asked.kind == Flight::Kind::kCommand ||
      device.protocol->traits().identity == AnswerIdentity::kNone)
    return device.spec->timeout;
  return device.areas[area_of(asked.request)].answer_time.timeout();
}

// Another device may be there when it comes back.
void BusEngine::State::forget_learned(DeviceIndex index) {
  DeviceRuntime& device = devices[index];
  device.answer_time.forget();
  device.pauses.forget();
  device.refused_longer = false;
  device.answered_at = kLongAgo;
  planned_times.forget(index);
  for (AreaIndex area = 0; area < device.areas.size(); ++area) {
    device.areas[area].answer_time.forget();
    if (device.areas[area].blocks.forget()) scheduler->set_longest(index, area, 0);
  }
}

// REQUIRES: the driver still holds what came.
void BusEngine::State::judge_garbage(DeviceIndex index, bool answered, Actions& actions) {
  Garbage& garbage = devices[index].garbage;
  if (answered) {
    if (garbage.answered())
      notice(Notice::Kind::kGarbageEnded, index, Cause::kNone, "its answers can be read again",
             actions);
  } else if (garbage.heard(driver.heard(), driver.sent())) {
    notice(Notice::Kind::kGarbage, index, Cause::kNone, garbage.text(line, over_network(spec.port)),
           actions);
  }
}

void BusEngine::State::device_failed(DeviceIndex index, Cause cause, Instant now,
                                     Actions& actions) {
  DeviceRuntime& device = devices[index];
  ++device.failures;
  if (!device.health.failed(cause, now)) return;
  if (!device.health.offline())
    return notice(Notice::Kind::kDeviceErrors, index, cause, std::string(to_text(cause)), actions);
  forget_learned(index);
  for (ChannelIndex c = channels.first_of(index); c < channels.end_of(index); ++c)
    channels.failing(c, cause, now);
  notice(Notice::Kind::kDeviceLost, index, cause,
         "does not answer; asked ever more rarely until it does", actions);
  const bool all_lost = std::all_of(devices.begin(), devices.end(),
                                    [](const DeviceRuntime& d) { return d.health.offline(); });
  if (all_lost && over_network(spec.port)) {
    // Every device behind this connection is silent: perhaps only the connection is dead.
    actions.push_back(Reopen{"no device answers"});
    bus_state = BusState::kOpening;
  }
}

// A device whose answers are often lost or broken shall not cost the others their refresh: it is
// asked again when the wire has time to waste, or when its failures would still be a small part of
// the wire's time.
void BusEngine::State::defer(DeviceIndex index, Duration wasted, Instant now) {
  devices[index].wasted = wasted;
  devices[index].deferred_until = now + wasted * kSickShare;
}

// Lets go of the deferred devices whose time has come; says when to look again for the others.
Instant BusEngine::State::admit_deferred(Instant now) {
  Instant next = kNever;
  std::optional<Duration> slack;
  for (DeviceIndex index = 0; index < devices.size(); ++index) {
    DeviceRuntime& device = devices[index];
    if (device.deferred_until == kLongAgo) continue;
    if (!slack) slack = scheduler->slack(now);
    if (now >= device.deferred_until || *slack > device.wasted) {
      device.deferred_until = kLongAgo;
      rest_device(index, now);
    } else {
      next = std::min(next, device.deferred_until);
    }
  }
  return next;
}

// Tells the scheduler how long the device is left alone.
void BusEngine::State::rest_device(DeviceIndex index, Instant now) {
  DeviceRuntime& device = devices[index];
  const bool stopped = device.health.offline() || device.deferred_until != kLongAgo;
  const Instant until = stopped ? kNever : std::max(now, device.paused_until);
  if (until == now && !device.resting) return;
  device.resting = until != now;
  scheduler->suspend(index, until);
}

std::optional<BusEngine::State::Flight> BusEngine::State::probe_due(Instant now) {
  for (DeviceIndex index = 0; index < devices.size(); ++index) {
    DeviceRuntime& device = devices[index];
    if (!device.health.offline() || next_probe_of(index) > now) continue;
    Flight probe;
    probe.kind = Flight::Kind::kProbe;
    probe.device = index;
    probe.request = ReadRequest{{map.points[*probe_point[index]].range}};
    if (const Instant from = askable_from(probe); from > now) {
      device.probe_not_before = from;
      continue;
    }
    const auto size = device.protocol->size(probe.request);
    const Duration wire =
        line.characters(size ? size->request_characters + size->answer_characters : 0) + silence;
    const Duration spare = scheduler->slack(now) - wire;
    probe.timeout = device.spec->timeout;
    if (spare < probe.timeout) {
      // Nothing to spare for a whole timeout. A while later the probe is made all the same, with
      // what can be spared.
      if (now < device.health.probe_at() + DeviceHealth::kLastProbe && spare < kShortestProbe) {
        device.probe_not_before = now + kProbeRetry;
        continue;
      }
      probe.timeout = std::clamp(spare, kShortestProbe, device.spec->timeout);
    }
    return probe;
  }
  return std::nullopt;
}

Instant BusEngine::State::next_probe_of(DeviceIndex index) const {
  const DeviceRuntime& device = devices[index];
  if (!device.health.offline() || !probe_point[index]) return kNever;
  return std::max({device.health.probe_at(), device.paused_until, device.probe_not_before});
}

Instant BusEngine::State::next_probe() const {
  Instant next = kNever;
  for (DeviceIndex index = 0; index < devices.size(); ++index)
    next = std::min(next, next_probe_of(index));
  return next;
}

}  // namespace fieldcast
