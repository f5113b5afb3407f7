#include "bridge/station/station.hpp"

#include <algorithm>
#include <chrono>
#include <map>
#include <mutex>
#include <utility>

#include "bridge/base/check.hpp"
#include "bridge/dds/topics/conversion.hpp"
#include "bridge/dds/topics/received_sample.hpp"
#include "bridge/dds/transport/domain.hpp"
#include "bridge/station/station_site.hpp"
#include "core/model/channel_pattern.hpp"

namespace fieldcast {

namespace {

// Makes a handler and its `gone` handler run one at a time across sites.
template <class Handler, class Gone>
void share_turn(Handler& handler, Gone& gone) {
  const auto mutex = std::make_shared<std::mutex>();
  handler = [mutex, inner = std::move(handler)](const auto& message) {
    const std::lock_guard lock(*mutex);
    inner(message);
  };
  if (!gone) return;
  gone = [mutex, inner = std::move(gone)](const auto&... message) {
    const std::lock_guard lock(*mutex);
    inner(message...);
  };
}

// Makes a handler of one site: puts the site's prefix before names of buses and bridges.
template <class Message>
std::function<void(const Message&)> at_site(const std::string& prefix,
                                            std::function<void(const Message&)> handler) {
  if (!handler || prefix.empty()) return handler;
  return [prefix, handler = std::move(handler)](Message message) {
    if constexpr (requires { message.bus; }) message.bus.insert(0, prefix);
    if constexpr (requires { message.pattern; }) message.pattern.insert(0, prefix);
    if constexpr (requires { message.alarm.bus; }) message.alarm.bus.insert(0, prefix);
    if constexpr (requires { message.bridge; }) message.bridge.insert(0, prefix);
    if constexpr (requires { message.buses; })
      for (auto& each : message.buses) each.bus.insert(0, prefix);
    handler(message);
  };
}
Station::OnGone at_site(const std::string& prefix, const Station::OnGone& gone) {
  if (!gone || prefix.empty()) return gone;
  return [prefix, gone](const std::string& bus, const std::string& device,
                        const std::string& channel) { gone(prefix + bus, device, channel); };
}

}  // namespace

struct Station::State {
  explicit State(const std::string& name) : identity(name) {}

  // Subscribes the topic at every site. `convert(site, received)` returns the message, or an empty
  // std::optional if it is not valid; `convert_last` does so for the last one of an instance.
  template <class Message, class Generated, class Convert, class ConvertLast>
  void subscribe(const Topic<Generated>& topic, std::function<void(const Message&)> handler,
                 std::function<void(const Message&)> gone, Convert convert,
                 ConvertLast convert_last) {
    if (sites.size() > 1) share_turn(handler, gone);
    for (const auto& site : sites) {
      const auto converted = [&](const auto& to, auto by) {
        return [to = at_site(site->prefix, to), by, &at = *site](const auto& received) {
          if (const std::optional<Message> message = by(at, received)) to(*message);
        };
      };
      typename fieldcast::Subscription<Generated>::Handlers handlers;
      handlers.sample = converted(handler, convert);
      if (gone) handlers.gone = converted(gone, convert_last);
      try {
        site->template subscribe<Generated>(topic, reader_qos(topic), std::move(handlers));
      } catch (const DdsError&) {
        if (!topic.is_optional) throw;
      }
    }
  }
  template <class Message, class Generated>
  void subscribe(const Topic<Generated>& topic, std::function<void(const Message&)> handler,
                 std::function<void(const Message&)> gone) {
    const auto convert = [](Site&, const auto& received) { return from_idl(received); };
    subscribe(topic, std::move(handler), std::move(gone), convert, convert);
  }

  // Returns the client of the site that a bus names, and removes the site from the name.
  [[nodiscard]] tl::expected<CommandClient*, StationFault> take_site(std::string& bus) {
    for (const auto& site : sites) {
      if (!bus.starts_with(site->prefix)) continue;
      bus.erase(0, site->prefix.size());
      if (!site->may_command()) return tl::unexpected(StationFault::kNoRight);
      return &site->client();
    }
    return tl::unexpected(StationFault::kNoSite);
  }
  // `bus` is a member of `message`.
  template <class Message>
  [[nodiscard]] StationOutcome execute(Message& message, std::string& bus, Duration wait_for_bridge,
                                       Duration wait_for_result) {
    const std::string named = bus;
    const auto client = take_site(bus);
    if (!client) return tl::unexpected(client.error());
    const auto id = (*client)->send(std::move(message), wait_for_bridge, true);
    if (!id) return tl::unexpected(id.error());
    StationOutcome outcome = (*client)->await(*id, wait_for_result);
    if (outcome) outcome->bus = named;
    return outcome;
  }

  StationIdentity identity;
  bool has_channels = false, has_samples = false;
  std::vector<std::unique_ptr<Site>> sites;
};

std::string_view to_text(StationFault fault) {
  switch (fault) {
    case StationFault::kNoBridge: return "no bridge serves the bus; it was not sent";
    case StationFault::kNoResult: return "no result came in time";
    case StationFault::kNotSent: return "the command does not fit the topic";
    case StationFault::kNotTaken: return "DDS did not take the command; send it again";
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

std::optional<std::string> pattern_at_site(std::string_view pattern, std::string_view site) {
  if (site.empty()) return std::string(pattern);
  const auto slash = pattern.find('/');
  const std::string_view bus = pattern.substr(0, slash);
  const std::string_view rest = slash == pattern.npos ? std::string_view{} : pattern.substr(slash);
  if (const auto colon = bus.find(kAfterSite); colon != bus.npos) {
    if (!glob_matches(bus.substr(0, colon), site)) return std::nullopt;
    return std::string(bus.substr(colon + 1)).append(rest);
  }
  // A star must match the end of the site's name; the last one that can leaves the longest pattern.
  const std::string prefix = std::string(site) + kAfterSite;
  for (auto star = bus.rfind('*'); star != bus.npos;
       star = star == 0 ? bus.npos : bus.rfind('*', star - 1)) {
    if (glob_matches(bus.substr(0, star + 1), prefix))
      return std::string(bus.substr(star)).append(rest);
  }
  return std::nullopt;
}

Station::Station(const std::vector<DdsSite>& sites, const std::string& name)
    : state_(std::make_unique<State>(name)) {
  for (const DdsSite& site : sites) {
    FIELDCAST_CHECK(sites.size() == 1 || !site.name.empty());
    try {
      state_->sites.push_back(std::make_unique<Site>(site, state_->identity));
    } catch (const DdsError& error) {
      if (site.name.empty()) throw;
      throw DdsError("site " + site.name + ": " + error.what());
    }
  }
}
Station::Station(const DdsSpec& spec, const std::string& name)
    : Station(std::vector{DdsSite{{}, spec}}, name) {}
Station::~Station() = default;

void Station::subscribe_samples(OnSample on_sample, OnGone gone, const SampleOptions& options) {
  FIELDCAST_CHECK(!state_->has_samples);
  if (state_->sites.size() > 1) share_turn(on_sample, gone);
  const auto names_of_last = [](OnGone to) {
    return [to = std::move(to)](const ReceivedSample& last) {
      to(last.sample.bus, last.sample.device, last.sample.channel);
    };
  };
  for (const auto& site : state_->sites) {
    OnSample to = at_site(site->prefix, on_sample);
    if (!options.one_by_one && !options.deadline && !options.on_deadline_missed) {
      site->by_blocks().subscribe_samples(std::move(to), at_site(site->prefix, gone));
      continue;
    }
    Subscription<idl::SamplePubSubType, ReceivedSampleType>::Handlers handlers;
    handlers.sample = [to = std::move(to)](const ReceivedSample& received) {
      if (received.is_known) to(received.sample);
    };
    if (gone) handlers.gone = names_of_last(at_site(site->prefix, gone));
    if (options.on_deadline_missed)
      handlers.deadline_missed = names_of_last(at_site(site->prefix, options.on_deadline_missed));
    site->subscribe<idl::SamplePubSubType, ReceivedSampleType>(
        kSampleTopic, sample_reader_qos(options.deadline), std::move(handlers));
  }
  state_->has_samples = true;
}

void Station::subscribe_channels(std::function<void(const StationChannel&)> on_channel,
                                 OnGone gone) {
  FIELDCAST_CHECK(!state_->has_channels);
  if (state_->sites.size() > 1) share_turn(on_channel, gone);
  for (const auto& site : state_->sites) {
    site->by_blocks().subscribe_channels(at_site(site->prefix, on_channel),
                                         at_site(site->prefix, gone));
  }
  state_->has_channels = true;
}

Station::BlockCounters Station::block_counters() const {
  BlockCounters all;
  for (const auto& site : state_->sites) {
    if (!site->blocks) continue;
    const auto [blocks, missing, requests] = site->blocks->counters();
    all.blocks += blocks;
    all.missing += missing;
    all.requests += requests;
  }
  return all;
}

void Station::subscribe_bus_status(std::function<void(const StationBusStatus&)> on_status,
                                   std::function<void(const StationBusStatus&)> gone) {
  const auto with_clock = [](Site& site, const idl::BusStatus& received) {
    StationBusStatus status = from_idl(received);
    const auto wall = std::chrono::system_clock::now().time_since_epoch();
    const auto monotonic = std::chrono::steady_clock::now().time_since_epoch();
    status.clock_ahead = site.clocks.add(
        status.bridge, status.bus, status.reported_at,
        UtcTime{std::chrono::duration_cast<Duration>(wall).count()}, Instant{monotonic});
    return status;
  };
  state_->subscribe(kBusStatusTopic, std::move(on_status), std::move(gone), with_clock,
                    [](Site&, const idl::BusStatus& last) { return from_idl(last); });
}

void Station::subscribe(const std::type_info& type, OnAny on_value, OnAny gone) {
  bool found = false;
  for_each_report([&]<class Generated>(const Report<Generated>& topic) {
    using Message = typename Generated::type;
    if constexpr (HasValue<Message>) {
      using Reported = ValueOf<Message>;
      if (found || type != typeid(Reported)) return;
      const auto typed = [](OnAny handler) -> std::function<void(const Reported&)> {
        if (!handler) return {};
        return [inner = std::move(handler)](const Reported& value) { inner(&value); };
      };
      state_->subscribe<Reported>(topic, typed(std::move(on_value)), typed(std::move(gone)));
      found = true;
    }
  });
  FIELDCAST_CHECK(found);
}

void Station::subscribe_bridges(std::function<void(const StationBridge&)> on_bridge,
                                std::function<void(const StationBridge&)> gone) {
  const auto convert = [](Site&, const idl::Bridge& bridge) { return station_bridge(bridge); };
  state_->subscribe(kBridgeTopic, std::move(on_bridge), std::move(gone), convert, convert);
}

void Station::subscribe_read_plans(std::function<void(const StationReadPlan&)> on_plan,
                                   const std::function<void(const std::string& bus)>& gone) {
  const auto whole = [](Site& site, const idl::ReadPlan& part) {
    return site.plan_parts.on_part(part);
  };
  const auto last_bus = [](Site& site, const idl::ReadPlan& last) {
    std::optional<StationReadPlan> plan;
    if (last.block() != 0) return plan;  // a later plan has fewer parts
    site.plan_parts.forget(last.bus().c_str());
    plan.emplace().bus = last.bus().c_str();
    return plan;
  };
  std::function<void(const StationReadPlan&)> on_gone = [gone](const StationReadPlan& last) {
    if (gone) gone(last.bus);
  };
  state_->subscribe(kReadPlanTopic, std::move(on_plan), std::move(on_gone), whole, last_bus);
}

void Station::subscribe_interests(std::function<void(const Interest&)> on_interest,
                                  std::function<void(const Interest&)> gone) {
  static constexpr auto kOptional = optional(kInterestTopic);
  state_->subscribe(kOptional, std::move(on_interest), std::move(gone));
}

bool Station::may_command() const {
  return std::ranges::any_of(state_->sites, [](const auto& site) { return site->may_command(); });
}

bool Station::may_declare_interest() const {
  return std::ranges::any_of(state_->sites,
                             [](const auto& site) { return site->may_declare_interest(); });
}

void Station::declare_interest(const std::string& pattern, Duration refresh) {
  for (const auto& site : state_->sites) {
    const auto there = pattern_at_site(pattern, site->name);
    if (there && (state_->sites.size() == 1 || site->may_declare_interest()))
      site->write_interest(pattern, *there, refresh);
  }
}

void Station::withdraw_interest(const std::string& pattern) {
  for (const auto& site : state_->sites) {
    if (const auto there = pattern_at_site(pattern, site->name))
      site->write_interest(pattern, *there, std::nullopt);
  }
}

StationOutcome Station::execute(StationCommand command, Duration wait_for_bridge,
                                Duration wait_for_result) {
  const Duration longest = command.lifespan + wait_for_result;
  return state_->execute(command, command.bus, wait_for_bridge, longest);
}

StationOutcome Station::execute(AlarmAction action, Duration wait_for_bridge,
                                Duration wait_for_result) {
  return state_->execute(action, action.alarm.bus, wait_for_bridge, wait_for_result);
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
  const auto client = state_->take_site(command.bus);
  if (!client) return tl::unexpected(client.error());
  return (*client)->send(std::move(command), wait_for_bridge, false);
}

tl::expected<std::uint64_t, StationFault> Station::send(AlarmAction action,
                                                        Duration wait_for_bridge) {
  const auto client = state_->take_site(action.alarm.bus);
  if (!client) return tl::unexpected(client.error());
  return (*client)->send(std::move(action), wait_for_bridge, false);
}

void Station::on_result(std::function<void(const StationResult&)> handler) {
  std::function<void(const StationResult&)> none;
  if (state_->sites.size() > 1) share_turn(handler, none);
  for (const auto& site : state_->sites) {
    if (site->may_command()) site->client().on_result(at_site(site->prefix, handler));
  }
}

std::uint64_t Station::reserve_request_id() { return state_->identity.next_id++; }

tl::expected<HistoryResponse, StationFault> Station::history(HistoryRequest request,
                                                             Duration wait) {
  for (const auto& site : state_->sites) {
    if (!request.bus.starts_with(site->prefix)) continue;
    request.bus.erase(0, site->prefix.size());
    HistoryParts parts(request);
    return site->stored().request(
        std::move(parts), wait,
        [&](const std::string& requester, std::uint64_t id, const auto& write) {
          request.requester = requester;
          request.request_id = id;
          idl::HistoryRequest message;
          to_idl(request, message);
          write(message);
        });
  }
  return tl::unexpected(StationFault::kNoSite);
}

void Station::end_history() {
  for (const auto& site : state_->sites) site->stored().end();
}

tl::expected<std::string, StationFault> Station::configuration(const std::string& bridge,
                                                               std::string request, Duration wait) {
  if (request.size() > ConfigurationMessage::kMostBytes || bridge.size() > kMaxNameLength)
    return tl::unexpected(StationFault::kNotSent);
  for (const auto& site : state_->sites) {
    if (!bridge.starts_with(site->prefix)) continue;
    return site->configuration().request(
        {}, wait, [&](const std::string& requester, std::uint64_t id, const auto& write) {
          to_parts<idl::ConfigurationRequest>(
              {requester, id, bridge.substr(site->prefix.size()), std::move(request)}, write);
        });
  }
  return tl::unexpected(StationFault::kNoSite);
}

void Station::cancel_configuration() {
  for (const auto& site : state_->sites) site->configuration().cancel();
}

std::vector<std::string> Station::missing_servers() const {
  std::vector<std::string> missing;
  for (const auto& site : state_->sites) {
    for (std::string& server : site->domain.missing_servers()) {
      if (std::ranges::find(missing, server) == missing.end()) missing.push_back(std::move(server));
    }
  }
  return missing;
}

const std::string& Station::requester() const {
  return may_command() ? state_->identity.requester : state_->identity.short_name;
}

}  // namespace fieldcast
