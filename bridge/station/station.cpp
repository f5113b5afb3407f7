#include "bridge/station/station.hpp"

#include <atomic>
#include <chrono>
#include <map>
#include <memory>
#include <mutex>
#include <typeindex>
#include <utility>

#include "bridge/base/check.hpp"
#include "bridge/dds/topics/conversion.hpp"
#include "bridge/dds/topics/received_sample.hpp"
#include "bridge/dds/transport/domain.hpp"
#include "bridge/station/block_subscription.hpp"
#include "bridge/station/bus_table.hpp"
#include "bridge/station/clock_offsets.hpp"
#include "bridge/station/command_client.hpp"
#include "bridge/station/subscription.hpp"
#include "core/model/channel_pattern.hpp"

namespace fieldcast {

namespace {

using SampleSubscription = Subscription<idl::SamplePubSubType, ReceivedSampleType>;

}  // namespace

struct Station::State {
  State(const DdsSpec& spec, const std::string& station)
      : name(cut_text(station, 128)), domain(spec, station, nullptr) {}

  [[nodiscard]] bool may_write(const char* topic) const {
    const auto& member = domain.member();
    const security::TopicRight* right = security::right_of(topic);
    return !member || (right != nullptr && right->writers.has(member->role));
  }

  // Created at the first command: a read-only station has no writers.
  CommandClient& client() {
    const std::lock_guard lock(mutex);
    if (!commands) commands = std::make_unique<CommandClient>(domain, name);
    return *commands;
  }

  BlockSubscription& by_blocks() {
    if (!blocks) blocks = std::make_unique<BlockSubscription>(domain, name);
    return *blocks;
  }

  const std::string name;
  Domain domain;
  std::mutex mutex;
  std::unique_ptr<SampleSubscription> samples;
  std::unique_ptr<BlockSubscription> blocks;
  bool has_channels = false, has_samples = false;
  ClockOffsets clocks;  // used by the subscription
  std::unique_ptr<Subscription<idl::BusStatusPubSubType>> buses;
  std::unique_ptr<Subscription<idl::BridgePubSubType>> bridges;
  std::map<std::type_index, std::shared_ptr<void>> reports;  // subscriptions, by their values
  PlanParts plan_parts;
  std::unique_ptr<Subscription<idl::ReadPlanPubSubType>> plans;
  dds::DataWriter* interests = nullptr;
  std::unique_ptr<CommandClient> commands;
  std::atomic<std::uint64_t> refused{0};  // commands for which this station has no right
};

std::string_view to_text(StationFault fault) {
  switch (fault) {
    case StationFault::kNoBridge: return "no bridge serves the bus; it was not sent";
    case StationFault::kNoResult: return "no result came in time";
    case StationFault::kNotSent: return "the command does not fit the topic";
    case StationFault::kNotAPath: return "a channel is named BUS/DEVICE/CHANNEL";
    case StationFault::kNoSite: return "of several sites, a bus is named SITE:BUS";
    case StationFault::kNoPerson:
      return "a person's name has 1 to 64 letters, digits, '-', '_', '.', '@'";
    case StationFault::kNoRight:
      return "this program may not command; that needs an identity of role plant";
  }
  return "?";
}

std::string to_text(const StationOutcome& outcome) {
  if (!outcome) return std::string(to_text(outcome.error()));
  std::string text(to_text(outcome->state));
  if (!outcome->reason.empty()) text += ": " + outcome->reason + " (" + outcome->cause + ")";
  return text;
}

bool was_not_run(const StationResult& result) {
  return result.state == CommandState::kRejected && result.cause == to_name(Cause::kShutdown);
}

Duration age(const StationSample& sample) {
  const auto now = std::chrono::system_clock::now().time_since_epoch();
  return std::chrono::duration_cast<Duration>(now) - Duration{sample.acquired_at.nanoseconds};
}

Station::Station(const DdsSpec& spec, const std::string& name)
    : state_(std::make_unique<State>(spec, name)) {}
Station::~Station() = default;

void Station::subscribe_samples(OnSample on_sample, OnGone gone, SampleOptions options) {
  FIELDCAST_CHECK(!std::exchange(state_->has_samples, true));
  if (!options.one_by_one && !options.deadline && !options.on_deadline_missed)
    return state_->by_blocks().subscribe_samples(std::move(on_sample), std::move(gone));
  SampleSubscription::Handlers handlers;
  handlers.sample = [on_sample = std::move(on_sample)](const ReceivedSample& received) {
    if (received.is_known) on_sample(received.sample);
  };
  if (gone) {
    handlers.gone = [gone = std::move(gone)](const ReceivedSample& last) {
      gone(last.sample.bus, last.sample.device, last.sample.channel);
    };
  }
  if (options.on_deadline_missed) {
    handlers.deadline_missed =
        [missed = std::move(options.on_deadline_missed)](const ReceivedSample& last) {
          missed(last.sample.bus, last.sample.device, last.sample.channel);
        };
  }
  state_->samples = std::make_unique<SampleSubscription>(
      state_->domain, kSampleTopic, sample_reader_qos(options.deadline), std::move(handlers));
}

void Station::subscribe_channels(std::function<void(const StationChannel&)> on_channel,
                                 OnGone gone) {
  FIELDCAST_CHECK(!std::exchange(state_->has_channels, true));
  state_->by_blocks().subscribe_channels(std::move(on_channel), std::move(gone));
}

Station::BlockCounters Station::block_counters() const {
  if (!state_->blocks) return {};
  const auto [blocks, missing, requests] = state_->blocks->counters();
  return {blocks, missing, requests};
}

void Station::subscribe_bus_status(std::function<void(const StationBusStatus&)> on_status,
                                   std::function<void(const StationBusStatus&)> gone) {
  FIELDCAST_CHECK(!state_->buses);
  Subscription<idl::BusStatusPubSubType>::Handlers handlers;
  handlers.sample = [on_status = std::move(on_status),
                     &clocks = state_->clocks](const idl::BusStatus& received) {
    StationBusStatus status = from_idl(received);
    const auto wall = std::chrono::system_clock::now().time_since_epoch();
    const auto monotonic = std::chrono::steady_clock::now().time_since_epoch();
    status.clock_ahead =
        clocks.add(status.bridge, status.bus, status.reported_at,
                   UtcTime{std::chrono::duration_cast<Duration>(wall).count()}, Instant{monotonic});
    on_status(status);
  };
  if (gone)
    handlers.gone = [gone = std::move(gone)](const idl::BusStatus& last) { gone(from_idl(last)); };
  state_->buses = std::make_unique<Subscription<idl::BusStatusPubSubType>>(
      state_->domain, kBusStatusTopic, std::move(handlers));
}

void Station::subscribe(const std::type_info& type, OnAny on_value, OnAny gone) {
  bool found = false;
  for_each_report([&]<class Generated>(const Report<Generated>& topic) {
    using Message = typename Generated::type;
    if constexpr (HasValue<Message>) {
      if (type != typeid(ValueOf<Message>)) return;
      const auto convert = [](OnAny handler) -> std::function<void(const Message&)> {
        if (!handler) return {};
        return [inner = std::move(handler)](const Message& message) {
          if (const auto value = value_of(message)) inner(&*value);
        };
      };
      typename Subscription<Generated>::Handlers handlers;
      handlers.sample = convert(std::move(on_value));
      handlers.gone = convert(std::move(gone));
      const auto [made, is_new] = state_->reports.try_emplace(type);
      FIELDCAST_CHECK(is_new);
      made->second =
          std::make_shared<Subscription<Generated>>(state_->domain, topic, std::move(handlers));
      found = true;
    }
  });
  FIELDCAST_CHECK(found);
}

void Station::subscribe_bridges(std::function<void(const StationBridge&)> on_bridge,
                                std::function<void(const StationBridge&)> gone) {
  FIELDCAST_CHECK(!state_->bridges);
  Subscription<idl::BridgePubSubType>::Handlers handlers;
  handlers.sample = [on_bridge = std::move(on_bridge)](const idl::Bridge& bridge) {
    on_bridge(station_bridge(bridge));
  };
  if (gone)
    handlers.gone = [gone = std::move(gone)](const idl::Bridge& last) {
      gone(station_bridge(last));
    };
  state_->bridges = std::make_unique<Subscription<idl::BridgePubSubType>>(
      state_->domain, kBridgeTopic, std::move(handlers));
}

void Station::subscribe_read_plans(std::function<void(const StationReadPlan&)> on_plan,
                                   std::function<void(const std::string& bus)> gone) {
  FIELDCAST_CHECK(!state_->plans);
  PlanParts& parts = state_->plan_parts;
  Subscription<idl::ReadPlanPubSubType>::Handlers handlers;
  handlers.sample = [&parts, on_plan = std::move(on_plan)](const idl::ReadPlan& part) {
    if (const auto plan = parts.on_part(part)) on_plan(*plan);
  };
  handlers.gone = [&parts, gone = std::move(gone)](const idl::ReadPlan& last) {
    if (last.block() != 0) return;  // a later plan has fewer parts
    parts.forget(last.bus().c_str());
    if (gone) gone(last.bus().c_str());
  };
  state_->plans = std::make_unique<Subscription<idl::ReadPlanPubSubType>>(
      state_->domain, kReadPlanTopic, std::move(handlers));
}

bool Station::may_command() const { return state_->may_write(kCommandTopic.name); }

bool Station::may_declare_interest() const { return state_->may_write(kInterestTopic.name); }

void Station::declare_interest(const std::string& pattern, Duration refresh) {
  if (state_->interests == nullptr) {
    state_->interests = state_->domain.writer(kInterestTopic, state_->name);
  }
  idl::Interest interest;
  interest.station() = state_->name;
  interest.pattern() = pattern;
  interest.refresh(refresh.count());
  state_->interests->write(&interest);
}

void Station::withdraw_interest(const std::string& pattern) {
  if (state_->interests == nullptr) return;
  idl::Interest interest;
  interest.station() = state_->name;
  interest.pattern() = pattern;
  state_->interests->unregister_instance(&interest, dds::HANDLE_NIL);  // disposes it
}

StationOutcome Station::execute(StationCommand command, Duration wait_for_bridge,
                                Duration wait_for_result) {
  if (!may_command()) return tl::unexpected(StationFault::kNoRight);
  return state_->client().execute(std::move(command), wait_for_bridge, wait_for_result);
}

StationOutcome Station::write(std::string_view path, Value value, bool verify) {
  auto named = ChannelPath::parse(path);
  if (!named) return tl::unexpected(StationFault::kNotAPath);
  StationCommand command;
  command.bus = std::move(named->bus);
  command.command.device = std::move(named->device);
  command.command.target = ChannelTarget{std::move(named->channel)};
  command.command.values = {std::move(value)};
  command.command.verify = verify;
  return execute(std::move(command));
}

tl::expected<std::uint64_t, StationFault> Station::send(StationCommand command,
                                                        Duration wait_for_bridge) {
  if (!may_command()) return tl::unexpected(StationFault::kNoRight);
  return state_->client().send(std::move(command), wait_for_bridge, false);
}

StationOutcome Station::execute(AlarmAction action, Duration wait_for_bridge,
                                Duration wait_for_result) {
  if (!may_command()) return tl::unexpected(StationFault::kNoRight);
  CommandClient& client = state_->client();
  const auto id = client.send(std::move(action), wait_for_bridge, true);
  if (!id) return tl::unexpected(id.error());
  return client.await(*id, wait_for_result);
}

tl::expected<std::uint64_t, StationFault> Station::send(AlarmAction action,
                                                        Duration wait_for_bridge) {
  if (!may_command()) return tl::unexpected(StationFault::kNoRight);
  return state_->client().send(std::move(action), wait_for_bridge, false);
}

void Station::on_result(std::function<void(const StationResult&)> handler) {
  if (may_command()) state_->client().on_result(std::move(handler));
}

std::uint64_t Station::reserve_request_id() {
  return may_command() ? state_->client().reserve_request_id() : ++state_->refused;
}

std::vector<std::string> Station::missing_servers() const {
  return state_->domain.missing_servers();
}

const std::string& Station::requester() const {
  return may_command() ? state_->client().requester() : state_->name;
}

}  // namespace fieldcast
