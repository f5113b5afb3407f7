#include "bridge/publish/bus_output.hpp"

#include <fmt/format.h>

#include <utility>

#include "bridge/base/clock.hpp"

namespace fieldcast {

StoreRecorder::StoreRecorder(Store& store, const BusSpec& bus)
    : store_(store), bus_(bus.name), intake_(store.intake(bus)) {
  for (const DeviceSpec& device : bus.devices)
    devices_[device.name] = {
        device.protocol, fmt::format("{}, {}", to_text(bus.port), address_text(device.link)), {}};
}

void StoreRecorder::put(std::span<const Sample> samples, const UtcMapping& mapping, Instant now) {
  intake_->put(samples, mapping, mapping.to_utc(now));
}

void StoreRecorder::put(std::string_view device, DeviceState state, UtcTime at) {
  const auto found = devices_.find(device);
  if (found == devices_.end() || found->second.state == state) return;
  found->second.state = state;
  store_.put(DeviceRecord{bus_, found->first, found->second.protocol, found->second.address,
                          std::string(to_text(state)), at});
}

BusOutput::BusOutput(const Shared& shared, const BusSpec& bus)
    : thread_(shared.thread),
      link_(shared.link),
      inputs_(shared.inputs),
      figures_(shared.figures),
      audit_(shared.audit),
      commands_(shared.commands),
      lease_(shared.lease),
      in_group_(shared.in_group),
      bus_(bus.name),
      most_now_(static_cast<std::size_t>(silence_of(bus.silence, line_of(bus.port)) / kOneSample)),
      alarms_(shared.alarms, bus) {
  if (shared.store) store_.emplace(*shared.store, bus);
}

template <class Task>
void BusOutput::post(Task task, PublisherThread::Late late) {
  ++waiting_;
  thread_.post(
      [this, task = std::move(task)] {
        task();
        --waiting_;
      },
      late);
}

void BusOutput::publish(std::vector<Sample> samples, const UtcMapping& mapping) {
  samples = hold_.pass(std::move(samples), lease_.holds(), steady_now());
  if (samples.empty()) return;
  const bool wanted = link_.publish_block(bus_, samples, mapping);  // by readers of Sample
  const bool later = wanted && (samples.size() > most_now_ || waiting_ != 0);
  if (wanted && !later) link_.publish_each(bus_, samples, mapping);
  inputs_.publish(bus_, samples);
  const Instant now = steady_now();
  if (store_) store_->put(samples, mapping, now);
  report(alarms_.on_samples(samples, mapping, now), mapping);
  if (!later) return;
  post(
      [this, samples = std::move(samples), mapping] { link_.publish_each(bus_, samples, mapping); },
      PublisherThread::Late::kDrop);
}

void BusOutput::promise(ChannelIndex channel, std::optional<Duration> gap) {
  post([this, channel, gap] { link_.set_refresh(bus_, channel, gap); });
}

void BusOutput::complete(const CommandResult& result, const UtcMapping& mapping) {
  if (commands_.is_of_gateway(bus_, result)) return;
  if (in_group_ && commands_.keeps_result(bus_, result)) return;
  audit_.completed(bus_, result);
  post([this, result, mapping] { link_.complete(bus_, result, mapping); });
}

void BusOutput::report(const BusReport& report, UtcTime at) {
  const UtcMapping now = read_clocks();
  const bool foreign =
      report.foreign_masters > std::exchange(foreign_masters_, report.foreign_masters);
  if (foreign && in_group_) hold_.foreign_master(steady_now());
  publish({}, now);  // samples that were held
  this->report(alarms_.on_time(now), now);
  post([this, report, at, reported = steady_now()] {
    link_.report(bus_, report, at);
    figures_.note(BusFigures{bus_, report, link_.counters(bus_), at, reported});
  });
}

void BusOutput::report(std::string_view device, const DeviceReport& report, UtcTime at) {
  if (store_) store_->put(device, report.state, at);
  post([this, device = std::string(device), report, at] {
    link_.report(bus_, device, report, at);
    figures_.note(DeviceFigures{bus_, device, report});
  });
}

void BusOutput::report(PlanReport plan, UtcTime at) {
  post([this, plan = std::move(plan), at] { link_.report(bus_, plan, at); });
}

void BusOutput::report(const std::vector<AlarmChange>& changes, const UtcMapping& mapping) {
  for (const AlarmChange& change : changes)
    post([this, change, mapping] { link_.report(bus_, change, mapping); });
}

}  // namespace fieldcast
