#include "core/bus/health/device_monitor.hpp"

#include <algorithm>

namespace fieldcast {

DeviceMonitor::DeviceMonitor(const BusSetup& setup, std::vector<std::optional<Range>> probed)
    : setup_(setup), probed_(std::move(probed)) {
  for (DeviceIndex index = 0; index < setup_.devices(); ++index)
    devices_.push_back(unknown_device(index));
  devices_.resize(setup_.slots(), Device(ResponseTime({}, {})));
}

DeviceMonitor::Device DeviceMonitor::unknown_device(DeviceIndex index) const {
  const Duration timeout = setup_.device(index).timeout;
  const ResponseTime unknown(timeout, std::max(setup_.spec().gap_allowance, timeout / 4));
  Device device(unknown);
  device.area_times.assign(setup_.protocol(index).areas().size(), unknown);
  return device;
}

void DeviceMonitor::Device::forget() {
  response_time.forget();
  for (ResponseTime& area : area_times) area.forget();
  pauses.forget();
  responded_at = kLongAgo;
}

Duration DeviceMonitor::rest_before(DeviceIndex index, Instant now) const {
  const Instant responded = devices_[index].responded_at;
  return responded == kLongAgo ? Duration::max() : now - responded;
}

Duration DeviceMonitor::timeout(DeviceIndex index, const Request& request, bool whole) const {
  if (whole || setup_.protocol(index).traits().identity == ResponseIdentity::kNone)
    return setup_.device(index).timeout;
  return devices_[index].area_times[area_of(request)].timeout();
}

void DeviceMonitor::tried(const Try& ended, Instant now, ActionSink& sink) {
  Device& device = devices_[ended.device];
  const bool done = ended.cause == Cause::kNone;
  const bool responded =
      done || ended.cause == Cause::kDeviceError || ended.cause == Cause::kDeviceBusy;
  // With several requests in flight, the device rests at no time.
  if (setup_.spec().in_flight == 1 && (done || ended.cause == Cause::kNoResponse))
    device.pauses.tried(ended.rest, done);
  if (done) device.responded_at = ended.responded;
  if (ended.cause == Cause::kDeviceBusy)
    ++device.busy_in_a_row;
  else if (responded)
    device.busy_in_a_row = 0;
  device.paused_until =
      now + std::max(setup_.device(ended.device).pause, device.pauses.next_pause());
  if (ended.cause == Cause::kNoResponse || ended.cause == Cause::kTruncated) {
    device.response_time.timed_out();
    for (ResponseTime& area : device.area_times) area.timed_out();
  }
  device.failure_share += ((responded && !device.busy() ? 0.0 : 1.0) - device.failure_share) / 8;
  judge_garbage(ended, responded, sink);
  if (!done) device.report.causes.add(ended.cause);
}

void DeviceMonitor::gateway_read_ended(DeviceIndex index, Cause cause, Instant now) {
  Device& device = devices_[index];
  device.gateway_read_failed = cause != Cause::kNone;
  if (cause == Cause::kNone) return;
  device.paused_until = now + setup_.device(index).pause;
  device.report.causes.add(cause);
}

Duration DeviceMonitor::longest_exchange(DeviceIndex index, const Request& request) const {
  const Device& device = devices_[index];
  const ResponseTime& time = device.response_time;
  // An ad-hoc device may do anything, also send a broken response to the last moment.
  if (setup_.is_ad_hoc(index))
    return setup_.wire_time(index, request) + setup_.silence() + setup_.device(index).pause +
           setup_.device(index).timeout + 2 * setup_.spec().gap_allowance;
  const bool known = time.known() && !device.sick() && !device.gateway_read_failed;
  return setup_.wire_time(index, request) + setup_.silence() + setup_.device(index).pause +
         (known ? std::min(time.longest(), time.mean() + 4 * time.spread())
                : setup_.device(index).timeout);
}

void DeviceMonitor::judge_garbage(const Try& ended, bool responded, ActionSink& sink) {
  Garbage& garbage = devices_[ended.device].garbage;
  anybody_responded_ = anybody_responded_ || responded;
  // An echo alone is reported only if no device ever responded and `echo` is not configured.
  const bool echo = ended.echo_alone && !anybody_responded_ && !setup_.spec().echo;
  if (responded) {
    if (garbage.responded())
      sink.notice(Notice::Kind::kGarbageEnded, ended.device, Cause::kNone,
                  "its responses can be read again");
  } else if (garbage.received(echo ? ended.sent : ended.received, ended.sent, ended.expected)) {
    sink.notice(Notice::Kind::kGarbage, ended.device, Cause::kNone,
                garbage.text(setup_.timeless() || setup_.datagrams() ? nullptr : &setup_.line(),
                             over_network(setup_.spec().port)));
  }
}

void DeviceMonitor::responded(DeviceIndex index, ActionSink& sink) {
  responded_since_opened_ = true;
  DeviceHealth& health = devices_[index].health;
  const bool was_offline = health.offline();
  if (health.responded() && was_offline)
    sink.notice(Notice::Kind::kDeviceBack, index, Cause::kNone,
                probed_[index] ? "responds again" : "sends again");
}

void DeviceMonitor::learn(DeviceIndex index, const Request& request, Duration response_time) {
  devices_[index].response_time.learn(response_time);
  if (std::holds_alternative<ReadRequest>(request))
    devices_[index].area_times[area_of(request)].learn(response_time);
}

void DeviceMonitor::inherit(DeviceIndex index, const DeviceReport& learned) {
  if (learned.response_time > Duration::zero())
    devices_[index].response_time.learn(learned.response_time);
  const auto areas = setup_.protocol(index).areas();
  for (const AreaReport& of_area : learned.areas) {
    for (std::size_t area = 0; area < areas.size(); ++area) {
      if (areas[area].name == of_area.area && of_area.response_time > Duration::zero())
        devices_[index].area_times[area].learn(of_area.response_time);
    }
  }
}

void DeviceMonitor::learn_late(DeviceIndex index, Duration response_time) {
  devices_[index].response_time.late(response_time);
  for (ResponseTime& area : devices_[index].area_times) area.late(response_time);
}

void DeviceMonitor::busy(DeviceIndex index, Instant now) {
  Device& device = devices_[index];
  device.paused_until = std::max(device.paused_until, now + kBusyPause);
}

bool DeviceMonitor::failed(DeviceIndex index, Cause cause, Instant now, ActionSink& sink,
                           bool connection_lost) {
  Device& device = devices_[index];
  ++device.report.failures;
  if (!device.health.failed(cause, now, connection_lost)) return false;
  if (!device.health.offline()) {
    sink.notice(Notice::Kind::kDeviceErrors, index, cause,
                cause == Cause::kPortClosed ? "the connection was closed when it was polled"
                                            : std::string(to_text(cause)));
    return false;
  }
  device.forget();
  sink.notice(Notice::Kind::kDeviceLost, index, cause,
              !probed_[index] ? "sends nothing any more"
              : connection_lost
                  ? "each request to it costs the connection; polled less and less often until it "
                    "responds"
              : cause == Cause::kDeviceBusy
                  ? "reports that it cannot respond now; polled less and less often until it can"
                  : "does not respond; polled less and less often until it does");
  return true;
}

bool DeviceMonitor::all_offline() const {
  const auto end = devices_.begin() + static_cast<std::ptrdiff_t>(setup_.devices());
  return std::all_of(devices_.begin(), end,
                     [](const Device& device) { return device.health.offline(); });
}

void DeviceMonitor::defer_if_sick(DeviceIndex index, Duration wasted, Instant now) {
  Device& device = devices_[index];
  if (!device.sick()) return;
  device.wasted = wasted;
  device.deferred_until = now + wasted * kSickShare;
}

Instant DeviceMonitor::admit_deferred(Instant now, const Slack& slack,
                                      std::vector<DeviceIndex>& admitted) {
  Instant next = kNever;
  std::optional<Duration> spare;
  for (DeviceIndex index = 0; index < setup_.devices(); ++index) {
    Device& device = devices_[index];
    if (device.deferred_until == kLongAgo) continue;
    if (!spare) spare = slack();
    if (now >= device.deferred_until || *spare > device.wasted) {
      device.deferred_until = kLongAgo;
      admitted.push_back(index);
    } else {
      next = std::min(next, device.deferred_until);
    }
  }
  return next;
}

std::optional<Instant> DeviceMonitor::suspension(DeviceIndex index, Instant now) {
  Device& device = devices_[index];
  const bool stopped = device.health.offline() || device.deferred_until != kLongAgo;
  const Instant until = stopped ? kNever : std::max(now, device.paused_until);
  if (until == now && !device.suspended) return std::nullopt;
  device.suspended = until != now;
  return until;
}

std::optional<DeviceMonitor::Probe> DeviceMonitor::probe(Instant now, const Gate& gate,
                                                         const Slack& slack) {
  for (DeviceIndex index = 0; index < setup_.devices(); ++index) {
    Device& device = devices_[index];
    if (!device.health.offline() || next_probe_of(index) > now) continue;
    const Request request = ReadRequest{{*probed_[index]}};
    if (const Instant from = gate(index, request); from > now) {
      device.probe_not_before = from;
      continue;
    }
    if (const auto timeout = probe_timeout(index, request, now, slack))
      return Probe{index, request, *timeout};
    device.probe_not_before = now + kProbeRetry;
  }
  return std::nullopt;
}

std::optional<DeviceMonitor::Probe> DeviceMonitor::sign(Instant now, const Gate& gate) const {
  std::optional<Probe> best;
  bool best_is_sick = true;
  for (DeviceIndex index = 0; index < setup_.devices(); ++index) {
    const Device& device = devices_[index];
    if (!probed_[index] || device.health.offline() || device.paused_until > now) continue;
    Request request = ReadRequest{{*probed_[index]}};
    if (gate(index, request) > now) continue;
    const bool sick = device.deferred_until != kLongAgo;
    const Duration takes =
        setup_.wire_time(index, request) + longest_response(index) + setup_.silence();
    const bool better = !best || (sick == best_is_sick ? takes < best->timeout : best_is_sick);
    if (!better) continue;
    best = Probe{index, std::move(request), takes};
    best_is_sick = sick;
  }
  return best;
}

// Empty if too short. After a while the probe is sent anyway.
std::optional<Duration> DeviceMonitor::probe_timeout(DeviceIndex index, const Request& request,
                                                     Instant now, const Slack& slack) const {
  const Duration wire = setup_.wire_time(index, request) + setup_.silence();
  const Duration spare = slack() - wire;
  const Duration whole = setup_.device(index).timeout;
  if (spare >= whole) return whole;
  const Instant due = devices_[index].health.probe_at();
  if (now < due + kProbePatience) return std::nullopt;
  const bool overdue = now >= due + DeviceHealth::kLastProbe;
  if (!overdue && spare < kShortestProbe) return std::nullopt;
  return std::clamp(spare, kShortestProbe, whole);
}

Instant DeviceMonitor::next_probe_of(DeviceIndex index) const {
  const Device& device = devices_[index];
  if (!device.health.offline() || !probed_[index]) return kNever;
  return std::max({device.health.probe_at(), device.paused_until, device.probe_not_before});
}

Instant DeviceMonitor::next_probe() const {
  Instant next = kNever;
  for (DeviceIndex index = 0; index < setup_.devices(); ++index)
    next = std::min(next, next_probe_of(index));
  return next;
}

void DeviceMonitor::opened(Instant now) {
  responded_since_opened_ = false;
  for (Device& device : devices_) {
    // A device that costs the connection would cost this one immediately.
    if (device.health.offline() && !device.health.connection_lost()) device.health.probe_from(now);
    device.probe_not_before = kLongAgo;
  }
}

std::optional<Duration> DeviceMonitor::earliest_response(DeviceIndex index) const {
  return devices_[index].response_time.earliest(setup_.line().characters(1));
}

bool DeviceMonitor::too_early(DeviceIndex index, Duration began) const {
  return devices_[index].response_time.too_early(began, setup_.line().characters(1));
}

DeviceReport DeviceMonitor::report(DeviceIndex index) const {
  const Device& device = devices_[index];
  DeviceReport report = device.report;
  report.state = device.health.state();
  report.response_time = device.response_time.mean();
  report.response_spread = device.response_time.spread();
  report.timeout = device.response_time.timeout();
  report.pause = std::max(setup_.device(index).pause, device.pauses.pause());
  for (AreaIndex area = 0; area < device.area_times.size(); ++area) {
    const ResponseTime& time = device.area_times[area];
    if (time.known())
      report.areas.push_back(
          {std::string(setup_.area(index, area).name), time.mean(), time.spread(), 0, 0});
  }
  return report;
}

}  // namespace fieldcast
