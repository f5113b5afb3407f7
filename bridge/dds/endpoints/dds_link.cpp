#include "bridge/dds/endpoints/dds_link.hpp"

#include <algorithm>
#include <type_traits>

#include "bridge/dds/endpoints/dds_link_state.hpp"
#include "core/model/command.hpp"

namespace fieldcast {

namespace {

// Number of single samples that fill a reader's socket like one block.
constexpr std::size_t kSamplesOfBlock = 32;

}  // namespace

bool stays_on_this_machine(const DdsSpec& spec) {
  const std::vector<std::string> used = used_interfaces(spec);
  return !spec.profile && !used.empty() &&
         std::all_of(used.begin(), used.end(),
                     [](const std::string& address) { return address.starts_with("127."); });
}

LinkedBus::LinkedBus(Domain& domain, const std::string& bridge, const BusSpec& served,
                     dds::DataWriter* catalogue_blocks, const BlockWriter::Stream& stream,
                     SnapshotSender& snapshots)
    : spec(served),
      catalogue(domain, catalogue_blocks, bridge, spec.name, stream.epoch,
                [&snapshots, name = spec.name] { snapshots.matched(name, true); }),
      blocks(domain, "fieldcast-bridge " + bridge + ": " + spec.name, stream, snapshots),
      samples(domain, bridge, spec, stream.most_bytes, blocks, snapshots) {
  ChannelIndex index = 0;
  for (const DeviceSpec& device : spec.devices) {
    for (const ChannelSpec& channel : device.channels)
      catalogue.add(device, channel, samples.refresh_of(index++));
    to_idl(bridge, spec, device, descriptions.emplace_back());
  }
  note_refreshes();
}

void LinkedBus::note_refreshes() {
  may_wait = samples.shortest_refresh() >= BurstRule::kLeastRefresh;
}

DdsLink::State::State(const DdsSpec& spec, const std::string& name, Handlers given)
    : bridge(name),
      handlers(std::move(given)),
      domain(spec, std::string(kBridgeParticipant) + name, &writers),
      block_bytes(stays_on_this_machine(spec) ? BlockWriter::kBytesOnLoopback
                                              : BlockWriter::kBytesOnNetworks),
      label("fieldcast-bridge " + name),
      results(domain, label, handlers.clock, handlers.on_problem),
      catalogue_blocks(domain.writer(kCatalogueBlockTopic, label)),
      reports(domain, label, handlers.on_problem) {
  interests = std::make_unique<InterestReceiver>(domain, handlers.on_interest, handlers.on_problem);
  if (handlers.bridges.received)
    presence = std::make_unique<BridgeAnnouncement>(domain, writers, label, handlers.bridges,
                                                    handlers.on_problem);
  listen_for_history();
  listen_for_configuration();
  snapshots = std::make_unique<SnapshotSender>(
      domain,
      [this](const std::string& bus, SnapshotSender::Part part) {
        return send_snapshot(bus, part);
      },
      handlers.on_readers);
}

SnapshotSender::Sent DdsLink::State::send_snapshot(const std::string& name,
                                                   SnapshotSender::Part part) {
  const std::shared_lock lock(mutex);
  LinkedBus* bus = find(name);
  if (bus == nullptr) return {};
  std::size_t blocks = 0;
  if (part == SnapshotSender::Part::kFirst) {
    bus->catalogue.flush();
    blocks = bus->blocks.write_snapshot();
  }
  const bool is_listed = bus->catalogue.wake(kSamplesOfBlock);
  const SampleWriters::Woken woken = bus->samples.wake(kSamplesOfBlock);
  return {blocks + (woken.written == 0 && is_listed ? 0 : 1), woken.all && is_listed};
}

// The first steps of a request, on a DDS thread: receive, authenticate, convert. Requests for other
// buses belong to other bridges.
template <class Message>
void DdsLink::State::receive(const Message& message, const RequestOrigin& origin) {
  const std::string bus = message.bus().c_str(), requester = message.requester().c_str();
  if (origin.bus && bus != *origin.bus) return;
  {
    const std::lock_guard lock(names_mutex);
    if (!names.contains(bus)) return;
  }
  auto terms = writers.terms_of(domain, requester, origin, handlers.clock());
  if (!terms)
    return handlers.on_problem("a request under the name of another's requester was dropped");
  results.remember(requester, origin.writer.guidPrefix);
  if (!terms->too_early.empty())
    return reject(message, terms->subject, {Cause::kExpired, std::move(terms->too_early)});
  constexpr bool is_command = std::is_same_v<Message, idl::Command>;
  if (!is_command && !terms->late.empty())
    return reject(message, terms->subject, {Cause::kExpired, std::move(terms->late)});
  auto request = from_idl(message);
  if (!request) return reject(message, terms->subject, request.error());
  request->subject = std::move(terms->subject);
  if constexpr (is_command) {
    request->expires = terms->expires;
    handlers.on_command(bus, *std::move(request), std::move(terms->late));
  } else {
    handlers.on_alarm_action(*std::move(request));
  }
}

DdsLink::State::Receivers DdsLink::State::listen(const HeldTo& bus) {
  const Instant now = handlers.clock().instant;
  Receivers made;
  made.commands = std::make_unique<Commands>(*this, domain, kCommandTopic, bus, now);
  if (handlers.on_alarm_action)
    made.actions = std::make_unique<Actions>(*this, domain, kAlarmActionTopic, bus, now);
  return made;
}

void DdsLink::State::Receivers::close() const {
  if (commands) commands->close();
  if (actions) actions->close();
}

template <class Message>
void DdsLink::State::reject(const Message& message, const std::string& subject,
                            const MalformedCommand& why) {
  if (standing_by) return;
  const UtcMapping now = handlers.clock();
  Command refused;
  refused.requester = message.requester().c_str();
  refused.request_id = message.request_id();
  refused.subject = subject;
  refused.device = message.device().c_str();
  if constexpr (std::is_same_v<Message, idl::Command>)
    refused.target = ChannelTarget{message.target().c_str()};
  else
    refused.target = ChannelTarget{message.channel().c_str()};
  const CommandResult result = rejection(refused, why.cause, why.reason, now.instant);
  if (handlers.on_rejected) handlers.on_rejected(message.bus().c_str(), refused, result);
  idl::CommandResult out;
  to_idl(message.bus().c_str(), result, now, out);
  results.send(out);
}

LinkedBus* DdsLink::State::find(std::string_view name) {
  const auto found = buses.find(name);
  return found == buses.end() ? nullptr : found->second.get();
}

void DdsLink::State::dispose(LinkedBus& bus, Duration linger, Duration limit) {
  const auto begun = std::chrono::steady_clock::now();
  bus.catalogue.dispose_blocks();
  bus.samples.dispose(linger, limit);
  if (std::chrono::steady_clock::now() - begun >= limit) return;
  bus.catalogue.dispose_channels();
  for (auto& [name, status] : bus.devices) reports.unregister(status);
  for (auto& [key, alarm] : bus.alarms) reports.unregister(alarm);
  for (auto& [key, status] : bus.alarm_status) reports.unregister(status);
  for (idl::ReadPlan& part : bus.plan) reports.unregister(part);
  for (idl::DeviceDescription& description : bus.descriptions) reports.unregister(description);
  if (bus.reported) reports.unregister(bus.status);
}

void DdsLink::State::wait_for_block_readers(Duration linger) {
  if (linger > Duration::zero()) catalogue_blocks->wait_for_acknowledgments(to_dds(linger));
}

DdsLink::DdsLink(const DdsSpec& spec, const std::string& bridge_name, Handlers handlers)
    : state_(std::make_unique<State>(spec, bridge_name, std::move(handlers))) {}

DdsLink::~DdsLink() { close(); }

std::unique_ptr<LinkedBus> DdsLink::State::made(const BusSpec& spec) {
  if (auto ready = prepared.extract(spec.name)) return std::move(ready.mapped());
  std::size_t channels = 0;
  for (const DeviceSpec& device : spec.devices) channels += device.channels.size();
  const auto epoch = static_cast<std::uint64_t>(handlers.clock().utc.nanoseconds);
  return std::make_unique<LinkedBus>(domain, bridge, spec, catalogue_blocks,
                                     BlockWriter::Stream{spec.name, channels, epoch, block_bytes},
                                     *snapshots);
}

void DdsLink::State::serve(const std::string& name, std::unique_ptr<LinkedBus> bus) {
  {
    const std::unique_lock lock(mutex);
    buses[name] = std::move(bus);
  }
  listen_for(name);
  snapshots->request(name);  // for readers that matched before the bus was added
}

void DdsLink::State::listen_for(const std::string& bus) {
  {
    const std::lock_guard names_lock(names_mutex);
    names.insert(bus);
  }
  if (!receivers.commands) receivers = listen({});
  if (domain.member() && !held.contains(bus)) held[bus] = listen(bus);
}

namespace {

// Reports that an endpoint is missing because the identity is older than its topic.
void report_missing_right(const DdsError& error,
                          const std::function<void(std::string text)>& on_problem) {
  on_problem(std::string(error.what()) +
             ": goes on without it; 'fieldcast secure renew' gives an identity of an "
             "earlier version this right");
}

}  // namespace

void DdsLink::State::listen_for_history() {
  if (!handlers.on_history) return;
  try {
    history = std::make_unique<HistoryEndpoint>(domain, label, block_bytes, handlers.on_history);
  } catch (const DdsError& error) { report_missing_right(error, handlers.on_problem); }
}

void DdsLink::State::listen_for_configuration() {
  if (!handlers.on_configuration) return;
  const auto received = [this](ConfigurationMessage request, const RequestOrigin& origin) {
    auto terms = writers.terms_of(domain, request.requester, origin, handlers.clock());
    if (!terms)
      return handlers.on_problem("a request under the name of another's requester was dropped");
    std::string fault = terms->too_early.empty() ? std::move(terms->late) : terms->too_early;
    handlers.on_configuration(std::move(request), std::move(terms->subject), std::move(fault));
  };
  try {
    configuration = std::make_unique<ConfigurationEndpoint>(domain, bridge, label,
                                                            handlers.clock().instant, received);
  } catch (const DdsError& error) { report_missing_right(error, handlers.on_problem); }
}

void DdsLink::add_bus(const BusSpec& spec) {
  auto bus = state_->made(spec);
  if (!bus->catalogue.publish())
    throw DdsError("dds: the catalogue of bus " + spec.name + " does not fit");
  for (idl::DeviceDescription& description : bus->descriptions) state_->reports.write(description);
  state_->serve(spec.name, std::move(bus));
}

void DdsLink::prepare_bus(const BusSpec& spec) {
  state_->prepared[spec.name] = state_->made(spec);
  state_->listen_for(spec.name);
}

void DdsLink::take_over_bus(const BusSpec& spec, const FollowedBus& followed) {
  auto bus = state_->made(spec);
  bus->catalogue.go_on_with(followed.epoch);
  bus->blocks.go_on_with(followed.epoch, followed.blocks, followed.state.samples,
                         state_->handlers.clock());
  state_->serve(spec.name, std::move(bus));
}

void DdsLink::ignore_requests(const std::string& bus) {
  {
    const std::lock_guard lock(state_->names_mutex);
    state_->names.erase(bus);
  }
  if (const auto held = state_->held.extract(bus)) held.mapped().close();
}

void DdsLink::stand_by(bool standing_by) { state_->standing_by = standing_by; }

std::vector<StandbyBusFigures> DdsLink::stream_figures() const {
  const std::shared_lock lock(state_->mutex);
  std::vector<StandbyBusFigures> figures;
  for (const auto& [name, bus] : state_->buses)
    figures.push_back({name, bus->catalogue.epoch(), bus->blocks.written()});
  return figures;
}

void DdsLink::respond(const HistoryRequest& request, const HistoryResponse& response) {
  if (state_->history) state_->history->respond(request, response);
}

void DdsLink::respond(const ConfigurationMessage& reply) {
  if (state_->configuration) state_->configuration->respond(reply);
}

std::vector<Quality> DdsLink::qualities(const BusSpec& bus) const {
  const std::shared_lock lock(state_->mutex);
  const LinkedBus* const found = state_->find(bus.name);
  std::vector<Quality> all;
  if (found == nullptr) return all;
  LastValue last;
  for (const DeviceSpec& device : bus.devices) {
    for (std::size_t i = 0; i < device.channels.size(); ++i) {
      const bool is_read = found->blocks.last_value(static_cast<ChannelIndex>(all.size()), last);
      all.push_back(is_read ? from_idl(last.quality).value_or(Quality::kNotYetRead)
                            : Quality::kNotYetRead);
    }
  }
  return all;
}

std::uint64_t DdsLink::epoch_of(std::string_view bus) const {
  const std::shared_lock lock(state_->mutex);
  const LinkedBus* const found = state_->find(bus);
  return found == nullptr ? 0 : found->catalogue.epoch();
}

Domain& DdsLink::domain() { return state_->domain; }

void DdsLink::listen_for_commands() {
  if (!state_->receivers.commands) state_->receivers = state_->listen({});
}

std::string DdsLink::id() const { return state_->presence->id(); }

void DdsLink::announce(const BridgeClaims& claims) { state_->presence->announce(claims); }

void DdsLink::wait_for_announcement(Duration limit) { state_->presence->wait_for_readers(limit); }

void DdsLink::publish_again(std::string_view name) {
  const std::unique_lock lock(state_->mutex);  // set_refresh() writes the catalogue too
  LinkedBus* bus = state_->find(name);
  if (bus == nullptr) return;
  (void)bus->catalogue.publish();
  for (auto& [key, alarm] : bus->alarms) state_->reports.write(alarm);
  for (auto& [key, status] : bus->alarm_status) state_->reports.write(status);
  for (idl::ReadPlan& part : bus->plan) state_->reports.write(part);
  for (idl::DeviceDescription& description : bus->descriptions) state_->reports.write(description);
}

void DdsLink::remove_bus(std::string_view name, Duration linger, Duration limit) {
  std::unique_ptr<LinkedBus> bus;
  {
    const std::unique_lock lock(state_->mutex);
    const auto found = state_->buses.find(name);
    if (found == state_->buses.end()) return;
    bus = std::move(found->second);
    state_->buses.erase(found);
  }
  bus->blocks.flush();
  state_->dispose(*bus, linger, limit);
  state_->wait_for_block_readers(linger);
  bus->catalogue.wait_for_readers(linger);
}

// The order matters: first stop receiving, then send the last results, then dispose the buses. The
// participant leaves when the state is destroyed.
void DdsLink::close(Duration linger, Leave leave) {
  if (state_->closed) return;
  state_->closed = true;
  state_->receivers.close();
  for (const auto& [bus, receivers] : state_->held) receivers.close();
  if (state_->history) state_->history->close();
  if (state_->configuration) state_->configuration->close();
  state_->interests->close();
  state_->snapshots->close();
  state_->bursts.close();
  state_->results.close(linger);
  std::map<std::string, std::unique_ptr<LinkedBus>, std::less<>> buses;
  {
    const std::unique_lock lock(state_->mutex);
    buses.swap(state_->buses);
  }
  state_->prepared.clear();
  for (auto& [name, bus] : buses) bus->blocks.flush();
  if (leave == Leave::kDispose) {
    for (auto& [name, bus] : buses) state_->dispose(*bus, Duration::zero());
  }
  const auto end = std::chrono::steady_clock::now() + linger;
  state_->wait_for_block_readers(linger);
  for (auto& [name, bus] : buses)
    bus->catalogue.wait_for_readers(end - std::chrono::steady_clock::now());
  // last: a bridge that waits for a bus takes it over now
  if (state_->presence) state_->presence->close();
}

}  // namespace fieldcast
