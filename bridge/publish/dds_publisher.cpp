#include "bridge/publish/dds_publisher.hpp"

namespace fieldcast {

DdsPublisher::DdsPublisher(PublisherThread& thread, DdsLink& link, MetricsTable& figures,
                           const BusSpec& bus)
    : thread_(thread),
      link_(link),
      figures_(figures),
      bus_(bus.name),
      most_now_(static_cast<std::size_t>(silence_of(bus.silence, line_of(bus.port)) / kOneSample)) {
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

bool DdsPublisher::publish_now(const std::vector<Sample>& samples, const UtcMapping& mapping) {
  if (!link_.publish_block(bus_, samples, mapping)) return true;
  if (samples.size() > most_now_ || waiting_ != 0) return false;
  link_.publish_each(bus_, samples, mapping);
  return true;
}

void DdsPublisher::publish_later(std::vector<Sample> samples, const UtcMapping& mapping) {
  post(
      [this, samples = std::move(samples), mapping] { link_.publish_each(bus_, samples, mapping); },
      PublisherThread::Late::kDrop);
}

void DdsPublisher::promise(ChannelIndex channel, std::optional<Duration> gap) {
  post([this, channel, gap] { link_.set_refresh(bus_, channel, gap); });
}

void DdsPublisher::complete(const CommandResult& result, const UtcMapping& mapping) {
  post([this, result, mapping] { link_.complete(bus_, result, mapping); });
}

void DdsPublisher::report(const BusReport& report, UtcTime at) {
  post([this, report, at] {
    link_.report(bus_, report, at);
    figures_.note(BusFigures{bus_, report, link_.counters(bus_), at});
  });
}

void DdsPublisher::report(std::string_view device, const DeviceReport& report, UtcTime at) {
  post([this, device = std::string(device), report, at] {
    link_.report(bus_, device, report, at);
    figures_.note(DeviceFigures{bus_, device, report});
  });
}

void DdsPublisher::report(PlanReport plan, UtcTime at) {
  post([this, plan = std::move(plan), at] { link_.report(bus_, plan, at); });
}

void DdsPublisher::report(const std::vector<AlarmChange>& changes, const UtcMapping& mapping) {
  for (const AlarmChange& change : changes)
    post([this, change, mapping] { link_.report(bus_, change, mapping); });
}

}  // namespace fieldcast
