// What the bus and its devices say of themselves.
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
  const DeviceRuntime& device = state_->devices[index];
  DeviceReport report;
  report.state = device.health.state();
  report.exchanges = device.exchanges;
  report.failures = device.failures;
  report.retries = device.retries;
  for (ChannelIndex c = state_->channels.first_of(index); c < state_->channels.end_of(index); ++c)
    report.deadline_misses += state_->channels.report(c, now).missed;
  report.answer_time = device.answer_time.mean();
  report.answer_spread = device.answer_time.spread();
  report.timeout = device.answer_time.timeout();
  report.pause = std::max(device.spec->pause, device.pauses.pause());
  for (AreaIndex area = 0; area < device.areas.size(); ++area) {
    const AreaLearning& learned = device.areas[area];
    if (!learned.answer_time.known()) continue;
    report.areas.push_back({std::string(device.protocol->areas()[area].name),
                            learned.answer_time.mean(), learned.answer_time.spread(),
                            learned.blocks.largest_read(), learned.blocks.longest()});
    for (const Range& gap : learned.blocks.gaps()) {
      if (report.refused_gaps.size() < State::kMaxRefusedListed)
        report.refused_gaps.push_back(state_->setup.text(index, gap));
    }
  }
  for (const auto& [point, code] : device.refused) {
    if (report.refused.size() == State::kMaxRefusedListed) break;
    report.refused.push_back(state_->point_text(point));
  }
  report.causes = device.causes;
  return report;
}

}  // namespace fieldcast
