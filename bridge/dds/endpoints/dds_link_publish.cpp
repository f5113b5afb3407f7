// Publishing of samples, results and reports.
#include <utility>

#include "bridge/base/check.hpp"
#include "bridge/dds/endpoints/dds_link.hpp"
#include "bridge/dds/endpoints/dds_link_state.hpp"
#include "bridge/dds/filter/sent_message.hpp"
#include "bridge/dds/guard/datagram_guard.hpp"

namespace fieldcast {

bool DdsLink::has_new_identity() const { return state_->domain.has_new_identity(); }

void DdsLink::publish(std::string_view name, std::span<const Sample> samples,
                      const UtcMapping& mapping) {
  if (publish_block(name, samples, mapping)) publish_each(name, samples, mapping);
}

bool DdsLink::publish_block(std::string_view name, std::span<const Sample> samples,
                            const UtcMapping& mapping) {
  const std::shared_lock lock(state_->mutex);
  LinkedBus* bus = state_->find(name);
  if (bus == nullptr) return false;
  const bool soon = bus->blocks.readers() > 0 &&
                    state_->bursts.waits(bus, state_->handlers.clock().instant) && bus->may_wait &&
                    !bus->samples.awake();
  bus->blocks.write(samples, mapping, soon ? BlockWriter::When::kSoon : BlockWriter::When::kNow);
  const bool each = bus->samples.awake();
  if (soon && each) bus->blocks.flush();
  if (soon && !each) state_->bursts.expect();
  return each;
}

void DdsLink::State::write_burst() {
  const std::shared_lock lock(mutex);
  const JoinedSending joined(block_bytes);
  for (const auto& [name, bus] : buses) bus->blocks.flush();
}

void DdsLink::publish_each(std::string_view name, std::span<const Sample> samples,
                           const UtcMapping& mapping) {
  const std::shared_lock lock(state_->mutex);
  LinkedBus* bus = state_->find(name);
  if (bus == nullptr) return;
  const bool failed = !bus->samples.write(samples, mapping);
  if (std::exchange(bus->write_failed, failed) || !failed) return;  // report the first of a row
  state_->handlers.on_problem("bus " + std::string(name) +
                              ": DDS did not take a sample; its readers do not acknowledge");
}

void DdsLink::set_refresh(std::string_view name, ChannelIndex channel,
                          std::optional<Duration> refresh) {
  const std::shared_lock lock(state_->mutex);
  LinkedBus* bus = state_->find(name);
  if (bus == nullptr || !bus->samples.move(channel, refresh)) return;
  bus->note_refreshes();
  bus->catalogue.set_refresh(channel, refresh);
  state_->snapshots->request(std::string(name));
}

void DdsLink::complete(std::string_view bus, const CommandResult& result,
                       const UtcMapping& mapping) {
  idl::CommandResult out;
  to_idl(bus, result, mapping, out);
  state_->results.send(out);
}

namespace {

// A message with all content in its value; others need the bus too.
template <class Message>
concept IsReported = HasValue<Message> && requires(const ValueOf<Message>& value, Message& out) {
  to_idl(value, out);
};

// Refused datagrams concern the whole bridge: the status of its first bus carries them.
void add_refused_datagrams(std::vector<idl::CauseCount>& causes) {
  const RtpsFaultCounts counts = refused_datagrams();
  for (std::size_t i = 0; i < counts.size(); ++i) {
    if (counts[i] == 0) continue;
    causes.emplace_back();
    causes.back().cause() = "DATAGRAM_" + std::string(to_text(static_cast<RtpsFault>(i)));
    causes.back().count(counts[i]);
  }
}

}  // namespace

void DdsLink::report(std::string_view name, const BusReport& report, UtcTime at) {
  const std::shared_lock lock(state_->mutex);
  LinkedBus* bus = state_->find(name);
  if (bus == nullptr) return;
  to_idl(state_->bridge, name, report, at, bus->status);
  if (bus == state_->buses.begin()->second.get()) add_refused_datagrams(bus->status.causes());
  bus->status.dds_deadline_misses(bus->samples.counters().deadline_misses);
  bus->reported = true;
  const Instant now = state_->handlers.clock().instant;
  bus->samples.tidy(now);
  bus->blocks.tidy(now);
  state_->reports.tidy(now);
  state_->reports.write(bus->status);
}

void DdsLink::report(std::string_view name, std::string_view device, const DeviceReport& report,
                     UtcTime at) {
  const std::shared_lock lock(state_->mutex);
  LinkedBus* bus = state_->find(name);
  if (bus == nullptr) return;
  idl::DeviceStatus& status = bus->devices[std::string(device)];
  to_idl(name, device, report, at, status);
  state_->reports.write(status);
}

void DdsLink::report(std::string_view name, const PlanReport& plan, UtcTime since) {
  const std::shared_lock lock(state_->mutex);
  LinkedBus* bus = state_->find(name);
  if (bus == nullptr) return;
  const std::uint64_t number = bus->plan.empty() ? static_cast<std::uint64_t>(since.nanoseconds)
                                                 : bus->plan.front().number() + 1;
  std::vector<idl::ReadPlan> parts = to_idl(name, plan, number, since);
  for (idl::ReadPlan& part : parts) state_->reports.write(part);
  for (std::size_t i = parts.size(); i < bus->plan.size(); ++i)
    state_->reports.unregister(bus->plan[i]);
  bus->plan = std::move(parts);
}

void DdsLink::report(const std::type_info& type, const void* value) {
  bool found = false;
  for_each_report([&]<class Generated>(const Report<Generated>&) {
    using Message = typename Generated::type;
    if constexpr (IsReported<Message>) {
      if (type != typeid(ValueOf<Message>)) return;
      Message out;
      to_idl(*static_cast<const ValueOf<Message>*>(value), out);
      state_->reports.write(out);
      found = true;
    }
  });
  FIELDCAST_CHECK(found);
}

void DdsLink::report(std::string_view name, const AlarmChange& change, const UtcMapping& mapping) {
  const std::shared_lock lock(state_->mutex);
  LinkedBus* bus = state_->find(name);
  if (bus == nullptr) return;
  const idl::Channel channel = bus->catalogue.message(change.channel);
  idl::Alarm& alarm = bus->alarms[{change.channel, change.limit}];
  alarm.bus() = channel.bus();
  alarm.device() = channel.device();
  alarm.channel() = channel.channel();
  to_idl(change, mapping, alarm);
  state_->reports.write(alarm);
}

void DdsLink::report(const AlarmKey& alarm, const AlarmStatus& status) {
  const std::shared_lock lock(state_->mutex);
  LinkedBus* bus = state_->find(alarm.bus);
  if (bus == nullptr) return;
  idl::AlarmStatus& out = bus->alarm_status[alarm];
  to_idl(alarm, status, out);
  state_->reports.write(out);
}

void DdsLink::forget(const AlarmKey& alarm) {
  const std::shared_lock lock(state_->mutex);
  LinkedBus* bus = state_->find(alarm.bus);
  if (bus == nullptr) return;
  if (auto gone = bus->alarm_status.extract(alarm)) state_->reports.unregister(gone.mapped());
}

std::vector<std::string> DdsLink::missing_servers() const {
  return state_->domain.missing_servers();
}

std::size_t DdsLink::unknown_bridges() const { return state_->domain.unknown_bridges(); }

DdsLink::BusCounters DdsLink::counters(std::string_view name) const {
  const std::shared_lock lock(state_->mutex);
  LinkedBus* bus = state_->find(name);
  if (bus == nullptr) return {};
  BusCounters counters = bus->samples.counters();
  counters.blocks = bus->blocks.written();
  counters.waited = bus->blocks.waited();
  counters.block_readers = bus->blocks.readers();
  return counters;
}

}  // namespace fieldcast
