#include "fieldcast/station.hpp"

#include <algorithm>
#include <map>
#include <mutex>
#include <set>
#include <stdexcept>
#include <utility>

#include "bridge/client/convert.hpp"
#include "bridge/station/sites.hpp"
#include "core/model/channel_pattern.hpp"

namespace fieldcast::api {
namespace {

Pattern parse(std::string_view text) {
  auto pattern = Pattern::parse(text);
  if (!pattern) throw std::invalid_argument(pattern.error());
  return *std::move(pattern);
}

bool matches(const Pattern& pattern, const Path& path) {
  return pattern.matches(path.bus, path.device, path.channel);
}

std::vector<DdsSite> sites_of(const std::vector<Domain>& domains) {
  if (domains.empty()) throw JoinError("no domain is given; name at least one");
  std::set<std::string> names;
  std::vector<DdsSite> sites;
  for (const Domain& domain : domains) {
    if (domains.size() > 1 && domain.name.empty())
      throw JoinError("each of several domains needs a name");
    if (!names.insert(domain.name).second)
      throw JoinError("two domains have the name " + domain.name);
    sites.push_back(api::to_inner(domain));
  }
  return sites;
}

std::string key_text(const AlarmKey& key) { return fieldcast::to_text(key); }

}  // namespace

inline namespace v1 {

Subscription& Subscription::operator=(Subscription&& other) noexcept {
  end();
  end_ = std::exchange(other.end_, nullptr);
  return *this;
}
void Subscription::end() {
  if (const auto ending = std::exchange(end_, nullptr)) ending();
}

struct Station::State {
  State(const std::string& given, std::vector<DdsSite> joined)
      : name(given), sites(std::move(joined)), inner(sites, name) {}

  template <class Message>
  Subscription add(Feed<Message>& feed, typename Feed<Message>::Handlers handlers) {
    return Subscription(feed.add(std::move(handlers)));
  }
  void receive_samples();
  void receive_channels();
  void receive_alarms();
  void receive_bus_status();
  void receive_device_status();
  void receive_bridges();
  void end_interest(const std::string& pattern, Duration refresh);
  Subscription subscribe_with_deadline(const Pattern& pattern,
                                       std::function<void(const Sample&)> on_sample,
                                       SampleOptions options);
  Result execute(StationCommand command, const CommandOptions& options);
  struct DeadlineWatch;

  const std::string name;
  const std::vector<DdsSite> sites;
  Feed<Sample> samples;
  Feed<Channel> channels;
  Feed<Alarm> alarms;
  Feed<BusStatus> buses;
  Feed<DeviceStatus> devices;
  Feed<Bridge> bridges;
  std::once_flag has_samples, has_channels, has_alarms, has_buses, has_devices, has_bridges;
  std::mutex interest_mutex;
  std::map<std::string, std::multiset<Duration>> interests;  // by pattern
  std::mutex watch_mutex;
  std::vector<std::shared_ptr<DeadlineWatch>> ended_watches;
  Sites inner;  // last: its threads use what is above
};

void Station::State::receive_samples() {
  std::call_once(has_samples, [this] {
    inner.subscribe_samples(
        [this](const StationSample& sample) {
          samples.publish(sample.path(), api::to_public(sample));
        },
        [this](const std::string& bus, const std::string& device, const std::string& channel) {
          samples.remove(Path{bus, device, channel}.text(), [](Sample&) {});
        });
  });
}

void Station::State::receive_channels() {
  std::call_once(has_channels, [this] {
    inner.subscribe_channels(
        [this](const StationChannel& channel) {
          channels.publish(channel.path(), api::to_public(channel));
        },
        [this](const std::string& bus, const std::string& device, const std::string& channel) {
          channels.remove(Path{bus, device, channel}.text(), [](Channel&) {});
        });
  });
}

void Station::State::receive_alarms() {
  std::call_once(has_alarms, [this] {
    inner.subscribe_alarm_status(
        [this](const StationAlarmStatus& status) {
          alarms.publish(key_text(status.alarm), api::to_public(status));
        },
        [this](const StationAlarmStatus& last) {
          alarms.remove(key_text(last.alarm), [](Alarm& alarm) { alarm.present = false; });
        });
  });
}

void Station::State::receive_bus_status() {
  std::call_once(has_buses, [this] {
    inner.subscribe_bus_status(
        [this](const StationBusStatus& status) {
          buses.publish(status.bridge + '/' + status.bus, api::to_public(status));
        },
        [this](const StationBusStatus& last) {
          buses.remove(last.bridge + '/' + last.bus,
                       [](BusStatus& status) { status.present = false; });
        });
  });
}

void Station::State::receive_device_status() {
  std::call_once(has_devices, [this] {
    inner.subscribe_device_status(
        [this](const StationDeviceStatus& status) {
          devices.publish(status.bus + '/' + status.device, api::to_public(status));
        },
        [this](const StationDeviceStatus& last) {
          devices.remove(last.bus + '/' + last.device,
                         [](DeviceStatus& status) { status.present = false; });
        });
  });
}

void Station::State::receive_bridges() {
  std::call_once(has_bridges, [this] {
    inner.subscribe_bridges(
        [this](const StationBridge& bridge) {
          bridges.publish(bridge.host + '/' + bridge.process, api::to_public(bridge));
        },
        [this](const StationBridge& last) {
          bridges.remove(last.host + '/' + last.process,
                         [](Bridge& bridge) { bridge.present = false; });
        });
  });
}

// DDS itself watches the deadline of each reader, so that this needs readers, and participants, of
// its own.
struct Station::State::DeadlineWatch {
  // Calls `handler` with the path if it is wanted and the subscription has not ended.
  void call(const std::function<void(const Path&)>& handler, const Path& path) {
    const std::lock_guard lock(turn);
    if (handler && !ended && matches(pattern, path)) handler(path);
  }
  void end() {
    end_samples();
    const std::lock_guard lock(turn);
    ended = true;
  }

  Pattern pattern;
  SampleOptions options;
  Feed<Sample> feed;
  std::function<void()> end_samples;
  std::recursive_mutex turn;  // held while on_missed or on_removed runs
  bool ended = false;
  std::vector<std::unique_ptr<fieldcast::Station>> stations;
};

Subscription Station::State::subscribe_with_deadline(const Pattern& pattern,
                                                     std::function<void(const Sample&)> on_sample,
                                                     SampleOptions options) {
  const auto watch = std::make_shared<DeadlineWatch>();
  watch->pattern = pattern;
  watch->options = std::move(options);
  watch->end_samples =
      watch->feed.add({.wants = [pattern](const Sample& s) { return matches(pattern, s.path); },
                       .on_message = std::move(on_sample),
                       .on_removed = {}});
  for (const DdsSite& site : sites) {
    auto station = std::make_unique<fieldcast::Station>(site.dds, name);
    const std::string prefix = site.name.empty() ? "" : site.name + ':';
    const auto to_path = [prefix](const std::string& bus, const std::string& device,
                                  const std::string& channel) {
      return Path{prefix + bus, device, channel};
    };
    station->subscribe_samples(
        [to = watch.get(), prefix](const StationSample& received) {
          Sample sample = api::to_public(received);
          sample.path.bus.insert(0, prefix);
          to->feed.publish(sample.path.text(), sample);
        },
        [to = watch.get(), to_path](const auto&... names) {
          to->call(to->options.on_removed, to_path(names...));
        },
        {.deadline = watch->options.refresh,
         .on_deadline_missed =
             [to = watch.get(), to_path](const auto&... names) {
               to->call(to->options.on_missed, to_path(names...));
             },
         .one_by_one = true});
    watch->stations.push_back(std::move(station));
  }
  // A handler may end its own subscription, and a participant cannot be removed on its own thread:
  // ended ones are removed by the next call, or with the station.
  std::vector<std::shared_ptr<DeadlineWatch>> removed;
  const std::lock_guard lock(watch_mutex);
  removed.swap(ended_watches);
  return Subscription([this, watch] {
    watch->end();
    const std::lock_guard ending(watch_mutex);
    ended_watches.push_back(watch);
  });
}

Result Station::State::execute(StationCommand command, const CommandOptions& options) {
  command.lifespan = options.lifespan;
  command.person = options.person;
  return api::to_public(
      inner.execute(std::move(command), options.wait_for_bridge, options.wait_for_result));
}

Station::Station(const std::string& name, const Domain& domain)
    : Station(name, std::vector<Domain>{domain}) {}

Station::Station(const std::string& name, const std::vector<Domain>& domains) {
  try {
    state_ = std::make_unique<State>(name, sites_of(domains));
  } catch (const DdsError& error) { throw JoinError(error.what()); }
}

Station::~Station() = default;

Subscription Station::subscribe(std::string_view pattern,
                                std::function<void(const Sample&)> on_sample,
                                SampleOptions options) {
  const Pattern wanted = parse(pattern);
  if (options.refresh > Duration{} || options.on_missed)
    return state_->subscribe_with_deadline(wanted, std::move(on_sample), std::move(options));
  state_->receive_samples();
  Feed<Sample>::Handler on_removed;
  if (options.on_removed) {
    on_removed = [handler = std::move(options.on_removed)](const Sample& last) {
      handler(last.path);
    };
  }
  return state_->add(
      state_->samples,
      {.wants = [wanted](const Sample& sample) { return matches(wanted, sample.path); },
       .on_message = std::move(on_sample),
       .on_removed = std::move(on_removed)});
}

Subscription Station::catalogue(std::string_view pattern,
                                std::function<void(const Channel&)> on_channel,
                                std::function<void(const Path&)> on_removed) {
  const Pattern wanted = parse(pattern);
  state_->receive_channels();
  Feed<Channel>::Handler removed;
  if (on_removed) {
    removed = [handler = std::move(on_removed)](const Channel& last) { handler(last.path); };
  }
  return state_->add(
      state_->channels,
      {.wants = [wanted](const Channel& channel) { return matches(wanted, channel.path); },
       .on_message = std::move(on_channel),
       .on_removed = std::move(removed)});
}

Subscription Station::alarms(std::string_view pattern,
                             const std::function<void(const Alarm&)>& on_alarm) {
  const Pattern wanted = parse(pattern);
  state_->receive_alarms();
  return state_->add(state_->alarms,
                     {.wants = [wanted](const Alarm& alarm) { return matches(wanted, alarm.path); },
                      .on_message = on_alarm,
                      .on_removed = on_alarm});
}

Subscription Station::bus_status(const std::function<void(const BusStatus&)>& on_status) {
  state_->receive_bus_status();
  return state_->add(state_->buses, {.wants = [](const BusStatus&) { return true; },
                                     .on_message = on_status,
                                     .on_removed = on_status});
}

Subscription Station::device_status(const std::function<void(const DeviceStatus&)>& on_status) {
  state_->receive_device_status();
  return state_->add(state_->devices, {.wants = [](const DeviceStatus&) { return true; },
                                       .on_message = on_status,
                                       .on_removed = on_status});
}

Subscription Station::bridges(const std::function<void(const Bridge&)>& on_bridge) {
  state_->receive_bridges();
  return state_->add(state_->bridges, {.wants = [](const Bridge&) { return true; },
                                       .on_message = on_bridge,
                                       .on_removed = on_bridge});
}

Subscription Station::interest(std::string_view pattern, Duration refresh) {
  const std::string text = parse(pattern).text();
  if (!state_->inner.may_declare_interest()) return {};
  const std::lock_guard lock(state_->interest_mutex);
  std::multiset<Duration>& refreshes = state_->interests[text];
  refreshes.insert(refresh);
  state_->inner.declare_interest(text, *refreshes.begin());
  return Subscription(
      [state = state_.get(), text, refresh] { state->end_interest(text, refresh); });
}

void Station::State::end_interest(const std::string& pattern, Duration refresh) {
  const std::lock_guard lock(interest_mutex);
  const auto found = interests.find(pattern);
  found->second.erase(found->second.find(refresh));
  if (!found->second.empty()) return inner.declare_interest(pattern, *found->second.begin());
  interests.erase(found);
  inner.withdraw_interest(pattern);
}

Result Station::write(std::string_view path, Value value, const CommandOptions& options) {
  const auto named = ChannelPath::parse(path);
  if (!named) return {.outcome = Outcome::kNotSent, .reason = named.error()};
  StationCommand command;
  command.bus = named->bus;
  command.command.device = named->device;
  command.command.target = ChannelTarget{named->channel};
  command.command.values = {std::move(value)};
  command.command.verify = options.verify;
  return state_->execute(std::move(command), options);
}

Result Station::acquire(std::string_view path, const CommandOptions& options) {
  const std::string whole =
      std::count(path.begin(), path.end(), '/') == 1 ? std::string(path) + "/*" : std::string(path);
  const auto named = ChannelPath::parse(whole);
  if (!named) return {.outcome = Outcome::kNotSent, .reason = named.error()};
  StationCommand command;
  command.bus = named->bus;
  command.command.device = named->device;
  command.command.operation = Operation::kAcquire;
  command.command.target = ChannelTarget{named->channel == "*" ? "" : named->channel};
  return state_->execute(std::move(command), options);
}

Result Station::acknowledge(const Alarm& alarm, const std::string& person,
                            const std::string& note) {
  AlarmAction action;
  action.kind = AlarmActionKind::kAcknowledge;
  action.alarm = key_of(alarm);
  action.by = person;
  action.note = note;
  action.raised_at = api::to_inner(alarm.raised_at);
  return api::to_public(state_->inner.execute(std::move(action)));
}

std::uint64_t Station::lost_blocks() const { return state_->inner.block_counters().missing; }

std::vector<std::string> Station::missing_servers() const {
  return state_->inner.missing_servers();
}

}  // namespace v1
}  // namespace fieldcast::api
