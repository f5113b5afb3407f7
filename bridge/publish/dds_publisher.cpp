#include "bridge/publish/dds_publisher.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "bridge/bus/clock.hpp"
#include "bridge/log/log.hpp"
#include "core/base/number_text.hpp"

namespace fieldcast {

DdsPublisher::DdsPublisher(PublisherThread& thread, DdsLink& link, Store* store,
                           CommandAudit& audit, AlarmTable& alarms, const BusSpec& bus)
    : thread_(thread),
      link_(link),
      store_(store),
      audit_(audit),
      spec_(bus),
      intake_(store ? store->intake(bus) : nullptr),
      active_(alarms),
      alarms_(bus),
      at_once_(static_cast<std::size_t>(silence_of(bus.silence, line_of(bus.port)) / kOneSample)) {
  for (const DeviceSpec& device : bus.devices) {
    devices_[device.name] = {
        device.protocol, fmt::format("{}, {}", to_text(bus.port), device.link.address), {}};
    for (const ChannelSpec& channel : device.channels)
      names_.emplace_back(device.name, channel.name);
  }
}

template <class Task>
void DdsPublisher::post(Task task, PublisherThread::Late late) {
  ++waiting_;
  thread_.post(
      [this, task = std::move(task)] {
        task();
        --waiting_;
      },
      late);
}

void DdsPublisher::publish(std::vector<Sample> samples, const UtcMapping& mapping) {
  if (samples.size() <= at_once_ && waiting_ == 0) {
    link_.publish(spec_.name, samples, mapping);
    return keep(samples, mapping, steady_now());
  }
  keep(samples, mapping, steady_now());
  post([this, samples = std::move(samples),
        mapping] { link_.publish(spec_.name, samples, mapping); },
       PublisherThread::Late::kDrop);
}

void DdsPublisher::promise(ChannelIndex channel, std::optional<Duration> gap) {
  post([this, channel, gap] { link_.set_refresh(spec_.name, channel, gap); });
}

void DdsPublisher::complete(const CommandResult& result, const UtcMapping& mapping) {
  audit_.answered(spec_.name, result);
  post([this, result, mapping] { link_.complete(spec_.name, result, mapping); });
}

void DdsPublisher::report(const BusReport& report, UtcTime at) {
  if (restored_ != active_.version()) restore_alarms();
  std::vector<AlarmChange> changes;
  const UtcMapping now = read_clocks();
  alarms_.on_time(now.instant, changes);
  tell(changes, now);
  post([this, report, at] { link_.report(spec_.name, report, at); });
}

void DdsPublisher::report(std::string_view device, const DeviceReport& report, UtcTime at) {
  const auto found = devices_.find(device);
  if (store_ && found != devices_.end() && found->second.state != report.state) {
    found->second.state = report.state;
    store_->put(DeviceRecord{spec_.name, found->first, found->second.protocol,
                             found->second.address, std::string(to_text(report.state)), at});
  }
  post([this, device = std::string(device), report, at] {
    link_.report(spec_.name, device, report, at);
  });
}

void DdsPublisher::keep(const std::vector<Sample>& samples, const UtcMapping& mapping,
                        Instant now) {
  if (intake_) intake_->put(samples, mapping, mapping.to_utc(now));
  if (restored_ != active_.version()) restore_alarms();
  std::vector<AlarmChange> changes;  // nearly always empty, and then it costs nothing
  alarms_.on_samples(samples, now, changes);
  tell(changes, mapping);
}

// What was active before this bus began goes on, or has ended meanwhile.
void DdsPublisher::restore_alarms() {
  restored_ = active_.version();
  const UtcMapping now = read_clocks();
  std::vector<AlarmChange> changes;
  for (const AlarmRecord& record : active_.active_of(spec_.name)) {
    const auto limit = limit_kind_from(record.limit);
    const auto name =
        std::find(names_.begin(), names_.end(), std::pair{record.device, record.channel});
    if (!limit || name == names_.end()) continue;
    alarms_.restore({static_cast<ChannelIndex>(name - names_.begin()), *limit, AlarmState::kActive,
                     record.value, now.to_instant(record.since)},
                    changes);
  }
  tell(changes, now, News::kRestored);
}

void DdsPublisher::tell(const std::vector<AlarmChange>& changes, const UtcMapping& mapping,
                        News news) {
  for (const AlarmChange& change : changes) {
    const auto& [device, channel] = names_.at(change.channel);
    const AlarmRecord record{spec_.name,
                             device,
                             channel,
                             std::string(to_text(change.limit)),
                             std::string(to_text(change.state)),
                             change.value,
                             mapping.to_utc(change.since)};
    const bool goes_on = news == News::kRestored && change.state == AlarmState::kActive;
    log_line(change.state == AlarmState::kActive ? LogLevel::kWarning : LogLevel::kInfo,
             fmt::format("{}/{}/{}", spec_.name, device, channel),
             fmt::format("alarm {} {}{}: {}", record.limit, goes_on ? "still " : "", record.state,
                         number_text(change.value)));
    active_.note(record);
    post([this, change, mapping] { link_.report(spec_.name, change, mapping); });
  }
}

}  // namespace fieldcast
