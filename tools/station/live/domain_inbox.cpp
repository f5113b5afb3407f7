#include "tools/station/live/domain_inbox.hpp"

#include <utility>

namespace fieldcast::web {
namespace {

std::string names(char kind, const std::string& a, const std::string& b = {}) {
  return std::string(1, kind) + a + '\x1F' + b;
}
std::string alarm_names(char kind, const LiveAlarm& alarm) {
  return names(kind, alarm.bus, alarm.device + '\x1F' + alarm.channel + '\x1F') +
         std::string(to_text(alarm.limit));
}

struct Deliver {
  LiveModel& model;
  bool gone;
  void operator()(const StationBusStatus& bus) const {
    gone ? model.on_bus_gone(bus.bus) : model.on_bus_status(bus);
  }
  void operator()(const StationDeviceStatus& device) const {
    gone ? model.on_device_gone(device.bus, device.device) : model.on_device_status(device);
  }
  void operator()(const LiveAlarm& alarm) const {
    gone ? model.on_alarm_gone(alarm) : model.on_alarm(alarm);
  }
  void operator()(const ProgramSessionReport& session) const { model.on_session(session); }
  void operator()(const StationBridge& bridge) const {
    gone ? model.on_bridge_gone(bridge.bridge) : model.on_bridge(bridge);
  }
  void operator()(const StationReadPlan& plan) const {
    gone ? model.on_read_plan_gone(plan.bus) : model.on_read_plan(plan);
  }
};

}  // namespace

bool DomainInbox::mark() { return !std::exchange(woken_, true); }

void DomainInbox::wake(bool first) {
  if (first) wake_();
}

DomainInbox::PathNews* DomainInbox::news_of(const PathView& path) {
  if (const auto found = batch_.by_path.find(path); found != batch_.by_path.end())
    return found->second;
  if (batch_.paths.size() >= LiveModel::kMaxChannels) {
    ++counters_.dropped;
    return nullptr;
  }
  PathNews& news = batch_.paths.emplace_back();
  news.path = path.owned();
  batch_.by_path.emplace(PathView{news.path}, &news);
  return &news;
}

void DomainInbox::on_channel(const StationChannel& channel) {
  bool first = false;
  {
    const std::lock_guard lock(mutex_);
    PathNews* const news = news_of({channel.bus, channel.device, channel.channel});
    if (news == nullptr) return;
    news->channel = std::make_unique<StationChannel>(channel);
    first = mark();
  }
  wake(first);
}

void DomainInbox::on_sample(const StationSample& sample) {
  bool first = false;
  {
    const std::lock_guard lock(mutex_);
    ++counters_.samples;
    PathNews* const news = news_of({sample.bus, sample.device, sample.channel});
    if (news == nullptr) return;
    if (std::exchange(news->has_value, true)) ++counters_.overtaken;
    news->value = {sample.value, sample.quality, sample.device_code, sample.acquired_at,
                   sample.sequence};
    first = mark();
  }
  wake(first);
}

void DomainInbox::on_gone(const std::string& bus, const std::string& device,
                          const std::string& channel) {
  bool first = false;
  {
    const std::lock_guard lock(mutex_);
    PathNews* const news = news_of({bus, device, channel});
    if (news == nullptr) return;
    news->gone = true;
    news->channel.reset();
    news->has_value = false;
    first = mark();
  }
  wake(first);
}

void DomainInbox::put(std::string key, Object object, bool gone) {
  bool first = false;
  {
    const std::lock_guard lock(mutex_);
    if (batch_.objects.size() >= kMaxObjects && !batch_.objects.contains(key)) {
      ++counters_.dropped;
      return;
    }
    batch_.objects.insert_or_assign(std::move(key), ObjectNews{std::move(object), gone});
    first = mark();
  }
  wake(first);
}

void DomainInbox::on_bus_status(const StationBusStatus& status) {
  put(names('b', status.bus), status, false);
}
void DomainInbox::on_bus_gone(const StationBusStatus& last) {
  put(names('b', last.bus), last, true);
}
void DomainInbox::on_device_status(const StationDeviceStatus& status) {
  put(names('d', status.bus, status.device), status, false);
}
void DomainInbox::on_device_gone(const StationDeviceStatus& last) {
  put(names('d', last.bus, last.device), last, true);
}
// Detailed alarms have separate keys, so the two kinds do not replace each other.
void DomainInbox::on_alarm(const StationAlarm& alarm) {
  const LiveAlarm live = live_alarm(alarm);
  put(alarm_names('a', live), live, false);
}
void DomainInbox::on_alarm_gone(const StationAlarm& last) {
  const LiveAlarm live = live_alarm(last);
  put(alarm_names('a', live), live, true);
}
void DomainInbox::on_alarm_status(const StationAlarmStatus& status) {
  const LiveAlarm live = live_alarm(status);
  put(alarm_names('A', live), live, false);
}
void DomainInbox::on_alarm_status_gone(const StationAlarmStatus& last) {
  const LiveAlarm live = live_alarm(last);
  put(alarm_names('A', live), live, true);
}
void DomainInbox::on_session(const ProgramSessionReport& session) {
  put(names('s', session.bus, session.device), session, false);
}
void DomainInbox::on_bridge(const StationBridge& bridge) {
  put(names('r', bridge.bridge), bridge, false);
}
void DomainInbox::on_bridge_gone(const StationBridge& last) {
  put(names('r', last.bridge), last, true);
}

void DomainInbox::on_read_plan(const StationReadPlan& plan) {
  put(names('p', plan.bus), plan, false);
}
void DomainInbox::on_read_plan_gone(const std::string& bus) {
  put(names('p', bus), StationReadPlan{.bus = bus}, true);
}

void DomainInbox::deliver(LiveModel& model, Instant now) {
  Batch batch;
  {
    const std::lock_guard lock(mutex_);
    woken_ = false;
    ++counters_.deliveries;
    std::swap(batch, batch_);
  }
  for (PathNews& news : batch.paths) {
    if (news.gone) model.on_gone(news.path);
    if (news.channel) model.on_channel(*news.channel);
    if (news.has_value) model.on_sample(news.path, std::move(news.value), now);
  }
  for (const auto& [key, news] : batch.objects) std::visit(Deliver{model, news.gone}, news.object);
}

DomainInbox::Counters DomainInbox::counters() const {
  const std::lock_guard lock(mutex_);
  return counters_;
}

}  // namespace fieldcast::web
