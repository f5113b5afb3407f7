#include "bridge/publish/alarm_reporter.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "bridge/base/clock.hpp"
#include "bridge/log/log.hpp"
#include "core/base/value.hpp"

namespace fieldcast {

AlarmReporter::AlarmReporter(AlarmTable& table, const BusSpec& bus)
    : table_(table), monitor_(bus), bus_(bus.name) {
  for (const DeviceSpec& device : bus.devices) {
    for (const ChannelSpec& channel : device.channels)
      names_.emplace_back(device.name, channel.name);
  }
}

std::vector<AlarmChange> AlarmReporter::on_samples(const std::vector<Sample>& samples,
                                                   const UtcMapping& mapping, Instant now) {
  std::vector<AlarmChange> all = restore();
  std::vector<AlarmChange> changes;
  monitor_.on_samples(samples, now, changes);
  note(changes, mapping, Origin::kNew);
  all.insert(all.end(), changes.begin(), changes.end());
  return all;
}

std::vector<AlarmChange> AlarmReporter::on_time(const UtcMapping& now) {
  table_.on_time(bus_, now.utc);
  std::vector<AlarmChange> all = restore();
  std::vector<AlarmChange> changes;
  monitor_.on_time(now.instant, changes);
  note(changes, now, Origin::kNew);
  all.insert(all.end(), changes.begin(), changes.end());
  return all;
}

std::vector<AlarmChange> AlarmReporter::restore() {
  std::vector<AlarmChange> changes;
  if (restored_ == table_.version()) return changes;
  restored_ = table_.version();
  const UtcMapping now = read_clocks();
  for (const AlarmRecord& record : table_.active_of(bus_)) {
    const auto limit = limit_kind_from(record.limit);
    const auto name =
        std::find(names_.begin(), names_.end(), std::pair{record.device, record.channel});
    if (!limit || name == names_.end()) continue;
    monitor_.restore({static_cast<ChannelIndex>(name - names_.begin()), *limit, AlarmState::kActive,
                      record.value, now.to_instant(record.since)},
                     changes);
  }
  note(changes, now, Origin::kRestored);
  return changes;
}

void AlarmReporter::note(const std::vector<AlarmChange>& changes, const UtcMapping& mapping,
                         Origin origin) {
  for (const AlarmChange& change : changes) {
    const auto& [device, channel] = names_.at(change.channel);
    const AlarmRecord record{bus_,
                             device,
                             channel,
                             std::string(to_text(change.limit)),
                             std::string(to_text(change.state)),
                             change.value,
                             mapping.to_utc(change.since)};
    const bool active = change.state == AlarmState::kActive;
    log_line(active ? LogLevel::kWarning : LogLevel::kInfo,
             fmt::format("{}/{}/{}", bus_, device, channel),
             fmt::format("alarm {} {}{}: {}", record.limit,
                         active && origin == Origin::kRestored ? "still " : "", record.state,
                         number_text(change.value)));
    table_.note(record);
  }
}

}  // namespace fieldcast
