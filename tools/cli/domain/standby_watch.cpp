#include "tools/cli/domain/standby_watch.hpp"

#include "tools/cli/terminal/clock.hpp"

namespace fieldcast::cli {
namespace {

constexpr Duration kLook = std::chrono::milliseconds{50};

}  // namespace

StandbyWatch::StandbyWatch(const Connection& connection) {
  for (const DdsSite& site : connection.sites) {
    sites_.push_back(std::make_unique<StandbyMonitor>(
        site.dds, "fieldcast-cli",
        StandbyMonitor::Handlers{[this](const StandbyMessage& message) { learn(message); },
                                 [this](const std::string& group, const std::string& bridge) {
                                   const std::lock_guard lock(mutex_);
                                   model_.erase({group, bridge});
                                 }}));
  }
}

bool StandbyWatch::request(const StandbyRequest& wanted, Duration limit) {
  bool heard = false;
  for (const auto& site : sites_) heard |= site->request(wanted, limit);
  return heard;
}

StandbyModel StandbyWatch::model() {
  const std::lock_guard lock(mutex_);
  return model_;
}

bool StandbyWatch::until(const std::function<bool(const StandbyModel&)>& condition, Instant end,
                         const std::function<bool()>& give_up) {
  std::unique_lock lock(mutex_);
  while (!condition(model_)) {
    if (give_up() || instant_now() >= end) return false;
    changed_.wait_for(lock, kLook);
  }
  return true;
}

void StandbyWatch::learn(const StandbyMessage& message) {
  const std::lock_guard lock(mutex_);
  const std::pair key{message.group, message.member.bridge};
  if (message.member.role == StandbyRole::kLeft) {
    model_.erase(key);
  } else {
    model_.insert_or_assign(key, message);
  }
  changed_.notify_all();
}

}  // namespace fieldcast::cli
