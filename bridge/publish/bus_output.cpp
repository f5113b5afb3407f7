#include "bridge/publish/bus_output.hpp"

#include <utility>

#include "bridge/base/clock.hpp"

namespace fieldcast {

BusOutput::BusOutput(const Shared& shared, const BusSpec& bus)
    : audit_(shared.audit),
      lease_(shared.lease),
      keeps_result_(shared.keeps_result),
      in_group_(shared.in_group),
      bus_(bus.name),
      dds_(shared.thread, shared.link, shared.figures, bus),
      alarms_(shared.alarms, bus) {
  if (shared.store) store_.emplace(*shared.store, bus);
}

void BusOutput::publish(std::vector<Sample> samples, const UtcMapping& mapping) {
  samples = hold_.pass(std::move(samples), lease_.holds(), steady_now());
  if (samples.empty()) return;
  const bool left = dds_.publish_now(samples, mapping);
  const Instant now = steady_now();
  if (store_) store_->put(samples, mapping, now);
  dds_.report(alarms_.on_samples(samples, mapping, now), mapping);
  if (!left) dds_.publish_later(std::move(samples), mapping);
}

void BusOutput::promise(ChannelIndex channel, std::optional<Duration> gap) {
  dds_.promise(channel, gap);
}

void BusOutput::complete(const CommandResult& result, const UtcMapping& mapping) {
  if (keeps_result_ && keeps_result_(bus_, result)) return;
  audit_.answered(bus_, result);
  dds_.complete(result, mapping);
}

void BusOutput::report(const BusReport& report, UtcTime at) {
  const UtcMapping now = read_clocks();
  const bool foreign =
      report.foreign_masters > std::exchange(foreign_masters_, report.foreign_masters);
  if (foreign && in_group_) hold_.foreign_master(steady_now());
  publish({}, now);  // samples that were held
  dds_.report(alarms_.on_time(now), now);
  dds_.report(report, at);
}

void BusOutput::report(std::string_view device, const DeviceReport& report, UtcTime at) {
  if (store_) store_->put(device, report.state, at);
  dds_.report(device, report, at);
}

void BusOutput::report(PlanReport plan, UtcTime at) { dds_.report(std::move(plan), at); }

}  // namespace fieldcast
