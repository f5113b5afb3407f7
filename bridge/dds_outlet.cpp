#include "bridge/dds_outlet.hpp"

#include <fmt/format.h>

#include "bridge/clock.hpp"
#include "bridge/log.hpp"

namespace fieldcast {

DdsOutlet::DdsOutlet(OutletThread& thread, DdsLink& link, Store* store, CommandAudit& audit, const BusSpec& bus)
    : thread_(thread),
      link_(link),
      store_(store),
      audit_(audit),
      spec_(bus),
      intake_(store ? store->intake(bus) : nullptr),
      alarms_(bus),
      at_once_(static_cast<std::size_t>(silence_of(bus.silence, line_of(bus.port)) / kOneSample)) {
  for (const DeviceSpec& device : bus.devices) {
    devices_[device.name] = {device.protocol, fmt::format("{}, {}", to_text(bus.port), device.link.address), {}};
    for (const ChannelSpec& channel : device.channels) names_.emplace_back(device.name, channel.name);
  }
}

template <class Task>
void DdsOutlet::post(Task task) {
  ++waiting_;
  thread_.post([this, task = std::move(task)] {
    task();
    --waiting_;
  });
}

void DdsOutlet::publish(std::vector<Sample> samples, const UtcMapping& mapping) {
  if (samples.size() <= at_once_ && waiting_ == 0) {
    link_.publish(spec_.name, samples, mapping);
    return keep(samples, mapping, steady_now());
  }
  keep(samples, mapping, steady_now());
  post([this, samples = std::move(samples), mapping] { link_.publish(spec_.name, samples, mapping); });
}

void DdsOutlet::promise(ChannelIndex channel, std::optional<Duration> gap) {
  post([this, channel, gap] { link_.set_refresh(spec_.name, channel, gap); });
}

void DdsOutlet::complete(const CommandResult& result, const UtcMapping& mapping) {
  audit_.answered(spec_.name, result);
  post([this, result, mapping] { link_.complete(spec_.name, result, mapping); });
}

void DdsOutlet::report(const BusReport& report, UtcTime at) {
  std::vector<AlarmChange> changes;
  const UtcMapping now = read_clocks();
  alarms_.on_time(now.instant, changes);
  tell(changes, now);
  post([this, report, at] { link_.report(spec_.name, report, at); });
}

void DdsOutlet::report(std::string_view device, const DeviceReport& report, UtcTime at) {
  const auto found = devices_.find(device);
  if (store_ && found != devices_.end() && found->second.state != report.state) {
    found->second.state = report.state;
    store_->put(DeviceRecord{spec_.name, found->first, found->second.protocol, found->second.address,
                             std::string(to_text(report.state)), at});
  }
  post([this, device = std::string(device), report, at] { link_.report(spec_.name, device, report, at); });
}

void DdsOutlet::keep(const std::vector<Sample>& samples, const UtcMapping& mapping, Instant now) {
  if (intake_) intake_->put(samples, mapping, mapping.to_utc(now));
  std::vector<AlarmChange> changes;  // nearly always empty, and then it costs nothing
  alarms_.on_samples(samples, now, changes);
  tell(changes, mapping);
}

void DdsOutlet::tell(const std::vector<AlarmChange>& changes, const UtcMapping& mapping) {
  for (const AlarmChange& change : changes) {
    const auto& [device, channel] = names_.at(change.channel);
    const AlarmRecord record{spec_.name,
                             device,
                             channel,
                             std::string(to_text(change.limit)),
                             std::string(to_text(change.state)),
                             change.value,
                             mapping.to_utc(change.since)};
    log_line(change.state == AlarmState::kActive ? LogLevel::kWarning : LogLevel::kInfo,
             fmt::format("{}/{}/{}", spec_.name, device, channel),
             fmt::format("alarm {} {}: {}", record.limit, record.state, change.value));
    if (store_) store_->put(record);
    post([this, change, mapping] { link_.report(spec_.name, change, mapping); });
  }
}

}  // namespace fieldcast
