#include "fieldcast/station.hpp"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <iterator>
#include <map>
#include <mutex>
#include <set>
#include <stdexcept>
#include <utility>

#include "bridge/client/convert.hpp"
#include "bridge/station/station.hpp"
#include "core/model/channel_pattern.hpp"

namespace fieldcast::api {
namespace {

// Of a command's times: their sums with a clock must not overflow.
constexpr Duration kLongest = std::chrono::hours{24};

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

auto by_path(Pattern pattern) {
  return [pattern = std::move(pattern)](const auto& message) {
    return matches(pattern, message.path);
  };
}

template <class Message>
typename Feed<Message>::Handler for_path(std::function<void(const Path&)> handler) {
  if (!handler) return {};
  return [handler = std::move(handler)](const Message& last) { handler(last.path); };
}

// The keys under which a Feed keeps its messages.
std::string key_of(const std::string& bus, const std::string& device, const std::string& channel) {
  return Path{bus, device, channel}.text();
}
std::string key_of(const StationSample& sample) { return sample.path(); }
std::string key_of(const StationChannel& channel) { return channel.path(); }
std::string key_of(const StationAlarmStatus& status) { return fieldcast::to_text(status.alarm); }
std::string key_of(const StationBusStatus& status) { return status.bridge + '/' + status.bus; }
std::string key_of(const StationDeviceStatus& status) { return status.bus + '/' + status.device; }
std::string key_of(const StationBridge& bridge) { return bridge.host + '/' + bridge.process; }
std::string key_of(const std::string& bus) { return bus; }
std::string key_of(const StationReadPlan& plan) { return plan.bus; }
std::string key_of(const ProgramSessionReport& one) { return one.bus + '/' + one.device; }

Result not_sent(std::string reason) {
  return {.outcome = Outcome::kNotSent, .reason = std::move(reason)};
}

// The channel of the result is "*".
tl::expected<ChannelPath, std::string> parse_device(std::string_view path) {
  return ChannelPath::parse(std::string(path) + "/*");
}

// Makes the exception of the public headers from the inner one.
template <class Function>
auto joining(Function function) {
  try {
    return function();
  } catch (const DdsError& error) { throw JoinError(error.what()); }
}

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

  // The messages of a topic, which the inner station receives from the first subscriber on.
  template <class Message>
  struct Received {
    Feed<Message> feed;
    std::atomic<bool> begun = false;
  };
  // `subscribe` is the function of the inner station for the topic.
  template <class Message, class Inner, class Gone>
  Subscription add(Received<Message>& topic,
                   void (fieldcast::Station::*subscribe)(std::function<void(const Inner&)>, Gone),
                   typename Feed<Message>::Handlers handlers) {
    Feed<Message>& feed = topic.feed;
    const auto received = [&feed](const Inner& message) {
      feed.publish(key_of(message), api::to_public(message));
    };
    const auto removed = [&feed](const auto&... last) {
      feed.remove(key_of(last...), [](Message& message) {
        if constexpr (requires { message.present; }) message.present = false;
      });
    };
    // Only the first caller subscribes, and no caller waits for it: it may wait for a handler.
    if (!topic.begun.exchange(true)) {
      try {
        (inner.*subscribe)(received, removed);
      } catch (const DdsError& error) {
        topic.begun = false;
        throw JoinError(error.what());
      }
    }
    return Subscription(feed.add(std::move(handlers)));
  }
  // For messages with `present`, which also report the end of their key.
  template <class Message, class Subscribe>
  Subscription add_all(Received<Message>& topic, Subscribe subscribe,
                       const std::function<void(const Message&)>& handler) {
    return add(topic, subscribe, {.wants = {}, .on_message = handler, .on_removed = handler});
  }
  void end_interest(const std::string& pattern, Duration refresh);
  struct DeadlineWatch;
  Subscription subscribe_with_deadline(const Pattern& pattern,
                                       std::function<void(const Sample&)> on_sample,
                                       SampleOptions options);
  Result execute(const ChannelPath& path, Command command, const CommandOptions& options);
  Result execute(std::string_view device, const Address& address, Command command,
                 const CommandOptions& options);

  const std::string name;
  const std::vector<DdsSite> sites;
  Received<Sample> samples;
  Received<Channel> channels;
  Received<Alarm> alarms;
  Received<BusStatus> buses;
  Received<DeviceStatus> devices;
  Received<Bridge> bridges;
  Received<ReadPlan> plans;
  Received<ProgrammingSession> sessions;
  std::mutex interest_mutex;
  std::map<std::string, std::multiset<Duration>> interests;  // by pattern
  std::mutex watch_mutex;
  std::vector<std::shared_ptr<DeadlineWatch>> ended_watches;
  fieldcast::Station inner;  // last: its threads use what is above
};

// DDS watches the deadline of each reader, so this needs readers and participants of its own.
struct Station::State::DeadlineWatch {
  void subscribe() {
    const auto to_path = [this](const std::function<void(const Path&)>& handler) {
      return [this, &handler](const auto&... names) {
        const Path path{names...};
        call(handler, path, path);
      };
    };
    station.subscribe_samples(
        [this](const StationSample& received) {
          const Sample sample = api::to_public(received);
          call(on_sample, sample.path, sample);
        },
        to_path(options.on_removed),
        {.deadline = options.refresh, .on_deadline_missed = to_path(options.on_missed)});
  }
  // Calls `handler` if the path is wanted and the subscription has not ended.
  template <class Message>
  void call(const std::function<void(const Message&)>& handler, const Path& path,
            const Message& message) {
    const std::lock_guard lock(turn);
    if (!handler || ended || !matches(pattern, path)) return;
    ++running;
    handler(message);
    --running;
  }
  void end() {
    const std::lock_guard lock(turn);
    ended = true;
  }

  const Pattern pattern;
  const std::function<void(const Sample&)> on_sample;
  const SampleOptions options;
  fieldcast::Station station;
  std::recursive_mutex turn{};  // held while a handler runs
  bool ended = false;
  std::atomic<int> running = 0;  // handlers
};

Subscription Station::State::subscribe_with_deadline(const Pattern& pattern,
                                                     std::function<void(const Sample&)> on_sample,
                                                     SampleOptions options) {
  const auto watch = joining([&] {
    return std::shared_ptr<DeadlineWatch>(
        new DeadlineWatch{pattern, std::move(on_sample), std::move(options), {sites, name}});
  });
  joining([&] { watch->subscribe(); });
  // A handler may end its own subscription, and a participant cannot be removed on its own thread:
  // ended ones are removed by the next call outside of their handlers, or with the station.
  std::vector<std::shared_ptr<DeadlineWatch>> removed;
  const std::lock_guard lock(watch_mutex);
  const auto idle = std::partition(ended_watches.begin(), ended_watches.end(),
                                   [](const auto& ended) { return ended->running > 0; });
  std::move(idle, ended_watches.end(), std::back_inserter(removed));
  ended_watches.erase(idle, ended_watches.end());
  return Subscription([this, watch] {
    watch->end();
    const std::lock_guard ending(watch_mutex);
    ended_watches.push_back(watch);
  });
}

Result Station::State::execute(const ChannelPath& path, Command command,
                               const CommandOptions& options) {
  command.device = path.device;
  command.verify = options.verify && command.operation == Operation::kWrite;
  const auto bounded = [](Duration time) { return std::min(time, kLongest); };
  return api::to_public(inner.execute({.bus = path.bus,
                                       .command = std::move(command),
                                       .lifespan = bounded(options.lifespan),
                                       .person = options.person},
                                      bounded(options.wait_for_bridge),
                                      bounded(options.wait_for_result)));
}

Result Station::State::execute(std::string_view device, const Address& address, Command command,
                               const CommandOptions& options) {
  const auto named = parse_device(device);
  if (!named) return not_sent(named.error());
  auto target = api::to_inner(address);
  if (!target) return not_sent(std::move(target.error()));
  command.target = *std::move(target);
  return execute(*named, std::move(command), options);
}

Station::Station(const std::string& name, const Domain& domain)
    : Station(name, std::vector<Domain>{domain}) {}

Station::Station(const std::string& name, const std::vector<Domain>& domains)
    : state_(joining([&] { return std::make_unique<State>(name, sites_of(domains)); })) {}

Station::~Station() = default;

Subscription Station::subscribe(std::string_view pattern,
                                std::function<void(const Sample&)> on_sample,
                                SampleOptions options) {
  const Pattern wanted = parse(pattern);
  if (options.refresh > Duration{})
    return state_->subscribe_with_deadline(wanted, std::move(on_sample), std::move(options));
  return state_->add(state_->samples, &fieldcast::Station::subscribe_samples,
                     {.wants = by_path(wanted),
                      .on_message = std::move(on_sample),
                      .on_removed = for_path<Sample>(std::move(options.on_removed))});
}

Subscription Station::catalogue(std::string_view pattern,
                                std::function<void(const Channel&)> on_channel,
                                std::function<void(const Path&)> on_removed) {
  return state_->add(state_->channels, &fieldcast::Station::subscribe_channels,
                     {.wants = by_path(parse(pattern)),
                      .on_message = std::move(on_channel),
                      .on_removed = for_path<Channel>(std::move(on_removed))});
}

Subscription Station::alarms(std::string_view pattern,
                             const std::function<void(const Alarm&)>& on_alarm) {
  return state_->add(
      state_->alarms, &fieldcast::Station::subscribe_alarm_status,
      {.wants = by_path(parse(pattern)), .on_message = on_alarm, .on_removed = on_alarm});
}

Subscription Station::bus_status(const std::function<void(const BusStatus&)>& on_status) {
  return state_->add_all(state_->buses, &fieldcast::Station::subscribe_bus_status, on_status);
}

Subscription Station::device_status(const std::function<void(const DeviceStatus&)>& on_status) {
  return state_->add_all(state_->devices, &fieldcast::Station::subscribe_device_status, on_status);
}

Subscription Station::bridges(const std::function<void(const Bridge&)>& on_bridge) {
  return state_->add_all(state_->bridges, &fieldcast::Station::subscribe_bridges, on_bridge);
}

Subscription Station::read_plans(const std::function<void(const ReadPlan&)>& on_plan) {
  return state_->add_all(state_->plans, &fieldcast::Station::subscribe_read_plans, on_plan);
}

Subscription Station::programming_sessions(
    const std::function<void(const ProgrammingSession&)>& on_session) {
  return state_->add_all(state_->sessions, &fieldcast::Station::subscribe<ProgramSessionReport>,
                         on_session);
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
  if (!named) return not_sent(named.error());
  return state_->execute(
      *named, {.target = ChannelTarget{named->channel}, .values = {std::move(value)}}, options);
}

Result Station::write(std::string_view device, const Address& address, std::vector<Value> values,
                      const CommandOptions& options) {
  const auto count = static_cast<std::uint32_t>(values.size());
  return state_->execute(device, address, {.values = std::move(values), .count = count}, options);
}

Result Station::acquire(std::string_view path, const CommandOptions& options) {
  const bool is_device = std::count(path.begin(), path.end(), '/') == 1;
  const auto named = is_device ? parse_device(path) : ChannelPath::parse(path);
  if (!named) return not_sent(named.error());
  const ChannelTarget target{named->channel == "*" ? "" : named->channel};
  return state_->execute(*named, {.target = target, .operation = Operation::kAcquire}, options);
}

Result Station::acquire(std::string_view device, const Address& address, std::uint32_t count,
                        const CommandOptions& options) {
  return state_->execute(device, address, {.operation = Operation::kAcquire, .count = count},
                         options);
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
