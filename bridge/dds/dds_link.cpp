#include "bridge/dds/dds_link.hpp"

#include <algorithm>
#include <map>
#include <mutex>
#include <set>
#include <shared_mutex>

#include "bridge/dds/alarm_action_receiver.hpp"
#include "bridge/dds/block_writer.hpp"
#include "bridge/dds/bridge_presence.hpp"
#include "bridge/dds/bus_catalogue.hpp"
#include "bridge/dds/command_receiver.hpp"
#include "bridge/dds/interest_receiver.hpp"
#include "bridge/dds/result_sender.hpp"
#include "bridge/dds/sample_writers.hpp"
#include "bridge/dds/snapshot_sender.hpp"
#include "core/model/command_refusal.hpp"

namespace fieldcast {

namespace {

// Whether every peer is on this machine, so that a message may be as long as UDP takes it.
// Transports of the user's profile are unknown.
bool stays_on_this_machine(const DdsSpec& spec) {
  const std::vector<std::string> used = used_interfaces(spec);
  return !spec.profile && !used.empty() &&
         std::all_of(used.begin(), used.end(),
                     [](const std::string& address) { return address.starts_with("127."); });
}

// Samples one by one that fill a reader's socket like a block.
constexpr std::size_t kSamplesOfBlock = 32;

// What one bus has in the domain besides the writers shared by all.
struct Bus {
  Bus(Domain& domain, const std::string& bridge, const BusSpec& spec,
      dds::DataWriter* catalogue_blocks, const BlockWriter::Stream& stream,
      std::function<void()> on_reader)
      : catalogue(domain, catalogue_blocks, bridge, spec.name, stream.epoch),
        blocks(domain, "fieldcast-bridge " + bridge + ": " + spec.name, stream, on_reader),
        samples(domain, bridge, spec, stream.most_bytes,
                {std::move(on_reader), [this](ChannelIndex channel, LastValue& out) {
                   return blocks.last_value(channel, out);
                 }}) {
    ChannelIndex index = 0;
    for (const DeviceSpec& device : spec.devices) {
      for (const ChannelSpec& channel : device.channels)
        catalogue.add(device, channel, samples.refresh_of(index++));
    }
  }
  BusCatalogue catalogue;
  BlockWriter blocks;  // keeps the last values, for both
  SampleWriters samples;
  std::map<std::string, idl::DeviceStatus> devices;                 // published at least once
  std::map<std::pair<ChannelIndex, LimitKind>, idl::Alarm> alarms;  // raised at least once
  std::map<AlarmKey, idl::AlarmStatus> alarm_status;                // published at least once
  idl::BusStatus status;
  std::vector<idl::ReadPlan> plan;  // its parts, as published
  bool reported = false;
  bool write_failed = false;
};

}  // namespace

struct DdsLink::State {
  State(const DdsSpec& spec, const std::string& name, Handlers given)
      : bridge(name),
        handlers(std::move(given)),
        domain(spec, "fieldcast-bridge " + name, &lifespans),
        block_bytes(stays_on_this_machine(spec) ? BlockWriter::kBytesOnLoopback
                                                : BlockWriter::kBytesOnNetworks),
        results(domain, "fieldcast-bridge " + name, handlers.clock, handlers.on_problem) {
    const std::string label = "fieldcast-bridge " + name;
    catalogue_blocks = domain.writer(kCatalogueBlockTopic, label);
    bus_status = domain.writer(kBusStatusTopic, label);
    alarms = domain.writer(kAlarmTopic, label);
    alarm_status = domain.writer(kAlarmStatusTopic, label);
    plans = domain.writer(kReadPlanTopic, label);
    device_status = domain.writer(kDeviceStatusTopic, label);
    sessions = domain.writer(kProgramSessionTopic, label);
    interests =
        std::make_unique<InterestReceiver>(domain, handlers.on_interest, handlers.on_problem);
    if (handlers.bridges.received)
      presence = std::make_unique<BridgePresence>(domain, label, handlers.bridges);
    snapshots = std::make_unique<SnapshotSender>(
        domain, [this](const std::string& bus, SnapshotSender::Part part) {
          return send_snapshot(bus, part);
        });
  }

  // On the thread of snapshots: what changed in the catalogue, then the last values.
  SnapshotSender::Sent send_snapshot(const std::string& name, SnapshotSender::Part part) {
    const std::shared_lock lock(mutex);
    Bus* bus = find(name);
    if (bus == nullptr) return {};
    std::size_t blocks = 0;
    if (part == SnapshotSender::Part::kFirst) {
      bus->catalogue.flush();
      blocks = bus->blocks.write_snapshot();
    }
    const SampleWriters::Woken woken = bus->samples.wake(kSamplesOfBlock);
    return {blocks + (woken.written == 0 ? 0 : 1), woken.all};
  }

  bool is_ours(const std::string& name) {
    const std::lock_guard lock(names_mutex);
    return names.contains(name);
  }

  CommandReceiver::Handlers command_handlers() {
    return {.clock = handlers.clock,
            .is_ours = [this](const std::string& name) { return is_ours(name); },
            .accepted = [this](const std::string& name,
                               Command command) { handlers.on_command(name, std::move(command)); },
            .refused = [this](const std::string& name, const idl::Command& command,
                              const MalformedCommand& why) { reject(name, command, why); },
            .received =
                [this](const std::string& requester, const CommandLifespans::Guid& writer) {
                  results.remember(requester, writer.guidPrefix);
                },
            .on_problem = handlers.on_problem};
  }

  AlarmActionReceiver::Handlers action_handlers() {
    return {.clock = handlers.clock,
            .is_ours = [this](const std::string& name) { return is_ours(name); },
            .accepted = [this](AlarmAction action) { handlers.on_alarm_action(std::move(action)); },
            .refused =
                [this](const idl::AlarmAction& action, const MalformedCommand& why) {
                  reject(action.bus().c_str(), action, why);
                },
            .received =
                [this](const std::string& requester, const CommandLifespans::Guid& writer) {
                  results.remember(requester, writer.guidPrefix);
                },
            .on_problem = handlers.on_problem};
  }

  void listen_for_held(const std::string& bus) {
    if (!domain.member() || held.contains(bus)) return;
    HeldReceivers& made = held[bus];
    made.commands =
        std::make_unique<CommandReceiver>(domain, lifespans, command_handlers(), HeldTo(bus));
    if (!handlers.on_alarm_action) return;
    made.actions =
        std::make_unique<AlarmActionReceiver>(domain, lifespans, action_handlers(), HeldTo(bus));
  }

  // What is nothing for a bus engine, or for the alarms, is answered here.
  template <class Message>
  void reject(const std::string& bus, const Message& message, const MalformedCommand& why) {
    const UtcMapping now = handlers.clock();
    Command refused;
    refused.requester = message.requester().c_str();
    refused.request_id = message.request_id();
    idl::CommandResult out;
    to_idl(bus, rejection(refused, why.cause, why.reason, now.instant), now, out);
    results.send(out);
  }

  // The bus, or null. REQUIRES: mutex held, shared or not.
  Bus* find(std::string_view name) {
    const auto found = buses.find(name);
    return found == buses.end() ? nullptr : found->second.get();
  }

  void dispose(Bus& bus, Duration linger, Duration limit = kInfinite) {
    const auto begun = std::chrono::steady_clock::now();
    bus.catalogue.dispose_blocks();
    bus.samples.dispose(linger, limit);
    if (std::chrono::steady_clock::now() - begun >= limit) return;
    bus.catalogue.dispose_channels();
    for (auto& [name, status] : bus.devices)
      device_status->unregister_instance(&status, dds::HANDLE_NIL);
    for (auto& [key, alarm] : bus.alarms) alarms->unregister_instance(&alarm, dds::HANDLE_NIL);
    for (auto& [key, status] : bus.alarm_status)
      alarm_status->unregister_instance(&status, dds::HANDLE_NIL);
    for (idl::ReadPlan& part : bus.plan) plans->unregister_instance(&part, dds::HANDLE_NIL);
    if (bus.reported) bus_status->unregister_instance(&bus.status, dds::HANDLE_NIL);
  }

  const std::string bridge;
  const Handlers handlers;
  CommandLifespans lifespans;
  Domain domain;
  const std::size_t block_bytes;
  ResultSender results;
  dds::DataWriter* catalogue_blocks = nullptr;
  dds::DataWriter* bus_status = nullptr;
  dds::DataWriter* device_status = nullptr;
  dds::DataWriter* sessions = nullptr;
  dds::DataWriter* alarms = nullptr;
  dds::DataWriter* alarm_status = nullptr;
  dds::DataWriter* plans = nullptr;
  std::unique_ptr<InterestReceiver> interests;
  std::unique_ptr<CommandReceiver> commands;     // since listen_for_commands()
  std::unique_ptr<AlarmActionReceiver> actions;  // the same, if they are wanted
  // The same for members that are held to a bus, since it was added: by bus.
  struct HeldReceivers {
    std::unique_ptr<CommandReceiver> commands;
    std::unique_ptr<AlarmActionReceiver> actions;

    void close() const {
      if (commands) commands->close();
      if (actions) actions->close();
    }
  };
  std::map<std::string, HeldReceivers, std::less<>> held;
  std::unique_ptr<BridgePresence> presence;
  std::shared_mutex mutex;  // the set of buses: shared to use one, alone to add or remove one
  std::map<std::string, std::unique_ptr<Bus>, std::less<>> buses;
  // Of the buses, once more: a thread of the library asks for them and holds locks of its own,
  // which whoever holds `mutex` may wait for when it makes a writer. Nothing is called under it.
  std::mutex names_mutex;
  std::set<std::string, std::less<>> names;
  bool closed = false;
  std::unique_ptr<SnapshotSender> snapshots;  // last: its thread uses the buses
};

DdsLink::DdsLink(const DdsSpec& spec, const std::string& bridge_name, Handlers handlers)
    : state_(std::make_unique<State>(spec, bridge_name, std::move(handlers))) {}

DdsLink::~DdsLink() { close(); }

void DdsLink::add_bus(const BusSpec& spec) {
  std::size_t channels = 0;
  for (const DeviceSpec& device : spec.devices) channels += device.channels.size();
  const auto epoch = static_cast<std::uint64_t>(state_->handlers.clock().utc.nanoseconds);
  auto bus = std::make_unique<Bus>(
      state_->domain, state_->bridge, spec, state_->catalogue_blocks,
      BlockWriter::Stream{spec.name, channels, epoch, state_->block_bytes},
      [state = state_.get(), name = spec.name] { state->snapshots->request(name); });
  if (!bus->catalogue.publish())
    throw DdsError("dds: the catalogue of bus " + spec.name + " does not fit");
  {
    const std::unique_lock lock(state_->mutex);
    state_->buses[spec.name] = std::move(bus);
    const std::lock_guard names_lock(state_->names_mutex);
    state_->names.insert(spec.name);
  }
  state_->snapshots->request(spec.name);  // readers that matched before the bus was there
  listen_for_commands();
  state_->listen_for_held(spec.name);
}

void DdsLink::listen_for_commands() {
  if (state_->commands) return;
  state_->commands = std::make_unique<CommandReceiver>(state_->domain, state_->lifespans,
                                                       state_->command_handlers());
  if (!state_->handlers.on_alarm_action) return;
  state_->actions = std::make_unique<AlarmActionReceiver>(state_->domain, state_->lifespans,
                                                          state_->action_handlers());
}

std::string DdsLink::id() const { return state_->presence->id(); }

void DdsLink::announce(const BridgeClaims& claims) { state_->presence->announce(claims); }

void DdsLink::publish_again(std::string_view name) {
  const std::unique_lock lock(state_->mutex);  // set_refresh() writes the catalogue too
  Bus* bus = state_->find(name);
  if (bus == nullptr) return;
  (void)bus->catalogue.publish();
  for (auto& [key, alarm] : bus->alarms) state_->alarms->write(&alarm);
  for (auto& [key, status] : bus->alarm_status) state_->alarm_status->write(&status);
  for (idl::ReadPlan& part : bus->plan) state_->plans->write(&part);
}

void DdsLink::remove_bus(std::string_view name, Duration linger, Duration limit) {
  std::unique_ptr<Bus> bus;
  {
    const std::unique_lock lock(state_->mutex);
    const auto found = state_->buses.find(name);
    if (found == state_->buses.end()) return;
    bus = std::move(found->second);
    state_->buses.erase(found);
    const std::lock_guard names_lock(state_->names_mutex);
    state_->names.erase(std::string(name));
  }
  if (const auto held = state_->held.extract(std::string(name))) held.mapped().close();
  state_->dispose(*bus, linger, limit);
  bus->catalogue.wait_for_readers(linger);
}

void DdsLink::publish(std::string_view name, std::span<const Sample> samples,
                      const UtcMapping& mapping) {
  if (publish_block(name, samples, mapping)) publish_each(name, samples, mapping);
}

bool DdsLink::publish_block(std::string_view name, std::span<const Sample> samples,
                            const UtcMapping& mapping) {
  const std::shared_lock lock(state_->mutex);
  Bus* bus = state_->find(name);
  if (bus == nullptr) return false;
  bus->blocks.write(samples, mapping);
  return bus->samples.awake();
}

void DdsLink::publish_each(std::string_view name, std::span<const Sample> samples,
                           const UtcMapping& mapping) {
  const std::shared_lock lock(state_->mutex);
  Bus* bus = state_->find(name);
  if (bus == nullptr || bus->samples.write(samples, mapping) || bus->write_failed) return;
  bus->write_failed = true;  // said once
  state_->handlers.on_problem("bus " + std::string(name) +
                              ": DDS did not take a sample; its readers do not acknowledge");
}

void DdsLink::set_refresh(std::string_view name, ChannelIndex channel,
                          std::optional<Duration> refresh) {
  const std::shared_lock lock(state_->mutex);
  Bus* bus = state_->find(name);
  if (bus == nullptr || !bus->samples.move(channel, refresh)) return;
  bus->catalogue.set_refresh(channel, refresh);
  state_->snapshots->request(std::string(name));
}

void DdsLink::complete(std::string_view bus, const CommandResult& result,
                       const UtcMapping& mapping) {
  idl::CommandResult out;
  to_idl(bus, result, mapping, out);
  state_->results.send(out);
}

void DdsLink::report(std::string_view name, const BusReport& report, UtcTime at) {
  const std::shared_lock lock(state_->mutex);
  Bus* bus = state_->find(name);
  if (bus == nullptr) return;
  to_idl(state_->bridge, name, report, at, bus->status);
  bus->status.dds_deadline_misses(bus->samples.counters().deadline_misses);
  bus->reported = true;
  bus->samples.tidy(state_->handlers.clock().instant);
  state_->bus_status->write(&bus->status);
}

void DdsLink::report(std::string_view name, std::string_view device, const DeviceReport& report,
                     UtcTime at) {
  const std::shared_lock lock(state_->mutex);
  Bus* bus = state_->find(name);
  if (bus == nullptr) return;
  idl::DeviceStatus& status = bus->devices[std::string(device)];
  to_idl(name, device, report, at, status);
  state_->device_status->write(&status);
}

void DdsLink::report(std::string_view name, const PlanReport& plan, UtcTime since) {
  const std::shared_lock lock(state_->mutex);
  Bus* bus = state_->find(name);
  if (bus == nullptr) return;
  const std::uint64_t number = bus->plan.empty() ? static_cast<std::uint64_t>(since.nanoseconds)
                                                 : bus->plan.front().number() + 1;
  std::vector<idl::ReadPlan> parts = to_idl(name, plan, number, since);
  for (idl::ReadPlan& part : parts) state_->plans->write(&part);
  for (std::size_t i = parts.size(); i < bus->plan.size(); ++i)
    state_->plans->unregister_instance(&bus->plan[i], dds::HANDLE_NIL);
  bus->plan = std::move(parts);
}

void DdsLink::report(const ProgramSessionReport& session) {
  idl::ProgramSession out;
  to_idl(session, out);
  state_->sessions->write(&out);
}

void DdsLink::report(std::string_view name, const AlarmChange& change, const UtcMapping& mapping) {
  const std::shared_lock lock(state_->mutex);
  Bus* bus = state_->find(name);
  if (bus == nullptr) return;
  const idl::Channel& channel = bus->catalogue.channels().at(change.channel);
  idl::Alarm& alarm = bus->alarms[{change.channel, change.limit}];
  alarm.bus() = channel.bus();
  alarm.device() = channel.device();
  alarm.channel() = channel.channel();
  to_idl(change, mapping, alarm);
  state_->alarms->write(&alarm);
}

void DdsLink::report(const AlarmKey& alarm, const AlarmStatus& status) {
  const std::shared_lock lock(state_->mutex);
  Bus* bus = state_->find(alarm.bus);
  if (bus == nullptr) return;
  idl::AlarmStatus& out = bus->alarm_status[alarm];
  to_idl(alarm, status, out);
  state_->alarm_status->write(&out);
}

void DdsLink::forget(const AlarmKey& alarm) {
  const std::shared_lock lock(state_->mutex);
  Bus* bus = state_->find(alarm.bus);
  if (bus == nullptr) return;
  if (auto gone = bus->alarm_status.extract(alarm))
    state_->alarm_status->unregister_instance(&gone.mapped(), dds::HANDLE_NIL);
}

DdsLink::BusCounters DdsLink::counters(std::string_view name) const {
  const std::shared_lock lock(state_->mutex);
  Bus* bus = state_->find(name);
  if (bus == nullptr) return {};
  BusCounters counters = bus->samples.counters();
  counters.blocks = bus->blocks.written();
  counters.block_readers = bus->blocks.readers();
  return counters;
}

// In this order: nothing new comes in, the last results go out, the buses say goodbye, the
// participant leaves with the state.
void DdsLink::close(Duration linger) {
  if (state_->closed) return;
  state_->closed = true;
  if (state_->commands) state_->commands->close();
  if (state_->actions) state_->actions->close();
  for (const auto& [bus, receivers] : state_->held) receivers.close();
  state_->interests->close();
  state_->snapshots->close();
  state_->results.close(linger);
  std::map<std::string, std::unique_ptr<Bus>, std::less<>> buses;
  {
    const std::unique_lock lock(state_->mutex);
    buses.swap(state_->buses);
  }
  for (auto& [name, bus] : buses) state_->dispose(*bus, Duration::zero());
  const auto end = std::chrono::steady_clock::now() + linger;
  for (auto& [name, bus] : buses)
    bus->catalogue.wait_for_readers(end - std::chrono::steady_clock::now());
  if (state_->presence) state_->presence->close();  // last: who waits for a bus takes it now
}

}  // namespace fieldcast
