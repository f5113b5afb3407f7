// What the bus and its devices say of themselves.
#include <algorithm>

#include "core/bus/bus_state.hpp"

namespace fieldcast {
BusReport BusEngine::bus_report(Instant now) {
  State& s = *state_;
  const bool reading = s.flight && s.flight->kind == State::Flight::Kind::kRead;
  const auto shares =
      s.load.report(s.flight ? now - s.flight->started : Duration::zero(), reading, now);
  BusReport report;
  report.state = s.bus_state;
  if (s.bus_state == BusState::kClosed) report.closed_because = s.closed_because;
  report.utilisation = shares.busy;
  report.measured_load = shares.reading;
  report.planned_load = s.scheduler->planned_load();
  report.stretch = s.scheduler->stretch();
  report.exchanges = s.exchanges;
  report.samples = s.samples;
  report.commands = s.commands.done();
  report.bytes_sent = s.driver.bytes_sent();
  report.bytes_received = s.driver.bytes_received();
  report.reopened = s.reopened;
  report.causes = s.causes;
  report.misses = s.channels.misses(now);
  report.deadline_misses = report.misses.total();
  return report;
}

ChannelReport BusEngine::channel_report(ChannelIndex channel, Instant now) const {
  return state_->channels.report(channel, now);
}

DeviceReport BusEngine::device_report(DeviceIndex index, Instant now) const {
  const State& s = *state_;
  const DeviceRuntime& device = s.devices[index];
  DeviceReport report = s.monitor->report(index);
  for (ChannelIndex c = s.channels.first_of(index); c < s.channels.end_of(index); ++c)
    report.deadline_misses += s.channels.report(c, now).missed;
  for (AreaReport& area : report.areas) {
    const auto areas = s.setup.protocol(index).areas();
    const auto at = std::find_if(areas.begin(), areas.end(),
                                 [&](const Area& each) { return each.name == area.area; });
    const BlockLearning& blocks = device.areas[static_cast<std::size_t>(at - areas.begin())];
    area.largest_block = blocks.largest_read();
    area.longest_block = blocks.longest();
    for (const Range& gap : blocks.gaps()) {
      if (report.refused_gaps.size() < State::kMaxRefusedListed)
        report.refused_gaps.push_back(s.setup.text(index, gap));
    }
  }
  for (const auto& [point, code] : device.refused) {
    if (report.refused.size() == State::kMaxRefusedListed) break;
    report.refused.push_back(state_->point_text(point));
  }
  return report;
}

}  // namespace fieldcast
