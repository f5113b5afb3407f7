#include "bridge/standby/bus_guard.hpp"

#include <fmt/format.h>
#include <pthread.h>

#include <utility>

#include "bridge/base/clock.hpp"
#include "bridge/standby/member_identity.hpp"

namespace fieldcast {

namespace {

constexpr Duration kAgain = std::chrono::milliseconds{50};

}  // namespace

BusGuard::BusGuard(std::string bridge, Handlers handlers) : handlers_(std::move(handlers)) {
  own_.bridge = std::move(bridge);
  own_.host = own_host_name();
  own_.process = own_process_identity();
  own_.since = read_clocks().utc;
}

BusGuard::~BusGuard() { end(); }

void BusGuard::found(const std::string& id) {
  const std::lock_guard lock(mutex_);
  silent_.insert(id);
}

void BusGuard::receive(const std::string& id, BridgeClaims claims) {
  const std::lock_guard lock(mutex_);
  silent_.erase(id);
  claims_.receive(id, std::move(claims));
  dirty_ = true;
  wake_.notify_all();
}

void BusGuard::set_alive(const std::string& id, bool alive) {
  const std::lock_guard lock(mutex_);
  claims_.set_alive(id, alive);
  dirty_ = true;
  wake_.notify_all();
}

void BusGuard::lost(const std::string& id) {
  const std::lock_guard lock(mutex_);
  silent_.erase(id);
  claims_.forget(id);
  dirty_ = true;
  wake_.notify_all();
}

void BusGuard::join_group(const std::string& group, std::int32_t strength) {
  const std::lock_guard lock(mutex_);
  own_.group = group;
  own_.strength = strength;
  claims_.set_group(group);
  claims_.set_standing_by(true);
}

void BusGuard::stand_by(bool standing_by) {
  {
    const std::lock_guard lock(mutex_);
    claims_.set_standing_by(standing_by);
    if (!settled_ || !claims_.decide(steady_now())) return;
    contested_ = claims_.contested();
  }
  announce();
}

void BusGuard::want(const std::string& id, const std::vector<std::string>& buses) {
  {
    const std::lock_guard lock(mutex_);
    claims_.set_id(id);
    claims_.want(buses, read_clocks().utc);
    if (wanted_at_ == kLongAgo) wanted_at_ = steady_now();
    if (settled_) (void)claims_.decide(steady_now());
  }
  announce();
}

bool BusGuard::withdraw() {
  {
    const std::lock_guard lock(mutex_);
    if (claims_.are_wanted_elsewhere()) return false;
    claims_.want({}, read_clocks().utc);
  }
  announce();
  return true;
}

void BusGuard::settle(const std::function<bool()>& give_up) {
  std::unique_lock lock(mutex_);
  const Instant began = own_.group.empty() ? wanted_at_ : steady_now();
  Settling settling(!own_.group.empty(), began);
  bool told = false;
  while (!give_up()) {
    lock.unlock();
    Finding finding = handlers_.finding();
    std::vector<std::string> heard = handlers_.members();
    lock.lock();
    // A bridge with this bridge's name does not appear there; see namesake().
    heard.push_back(own_.bridge);
    finding.silent += silent_.size();
    finding.unknown += claims_.members_beside(heard);
    const Instant now = steady_now();
    const auto what = settling.waits_for(finding, now);
    if (!what) break;
    if (now - began >= Settling::kLeast && !std::exchange(told, true)) {
      lock.unlock();
      handlers_.waits(*what);
      lock.lock();
    }
    wake_.wait_for(lock, kAgain);
  }
  lock.unlock();
  check_processes();
  lock.lock();
  settled_ = true;
  (void)claims_.decide(steady_now());
  contested_ = claims_.contested();
  const std::size_t unheard = silent_.size();
  lock.unlock();
  announce();
  if (unheard > 0 && handlers_.unheard) handlers_.unheard(unheard);
}

bool BusGuard::serves(const std::string& bus) const {
  const std::lock_guard lock(mutex_);
  return claims_.serves(bus);
}

std::string BusGuard::rival(const std::string& bus) const {
  const std::lock_guard lock(mutex_);
  const auto rival = claims_.rival(bus);
  return rival ? fmt::format("bridge '{}' on host {}", rival->bridge, rival->host) : "no bridge";
}

std::set<std::string> BusGuard::contested() const {
  const std::lock_guard lock(mutex_);
  return claims_.contested();
}

std::optional<BusClaims::Namesake> BusGuard::namesake() const {
  const std::lock_guard lock(mutex_);
  BridgeClaims own = own_;
  own.buses = claims_.buses();
  return claims_.namesake(own);
}

bool BusGuard::decide() {
  const bool changed = claims_.decide(steady_now());
  const auto contested = claims_.contested();
  changed_ |= changed || contested != contested_;
  for (const std::string& bus : std::exchange(contested_, contested)) {
    if (!contested.contains(bus) && claims_.serves(bus)) uncontested_.insert(bus);
  }
  return changed;
}

void BusGuard::announce() {
  const std::lock_guard one(announcing_);
  BridgeClaims claims;
  {
    const std::lock_guard lock(mutex_);
    claims = own_;
    claims.buses = claims_.buses();
  }
  handlers_.announce(claims);
}

void BusGuard::watch() {
  thread_ = std::thread([this] { run(); });
}

void BusGuard::end() {
  {
    const std::lock_guard lock(mutex_);
    ending_ = true;
    wake_.notify_all();
  }
  if (thread_.joinable()) thread_.join();
}

void BusGuard::run() {
  pthread_setname_np(pthread_self(), "guard");
  std::unique_lock lock(mutex_);
  while (!ending_) {
    dirty_ = false;
    if (decide()) {
      lock.unlock();
      announce();
      lock.lock();
      continue;
    }
    if (std::exchange(changed_, false)) {
      const auto uncontested = std::exchange(uncontested_, {});
      lock.unlock();
      const bool done = handlers_.changed(uncontested);
      lock.lock();
      if (done) continue;
      changed_ = true;
      uncontested_.insert(uncontested.begin(), uncontested.end());
      wake_.wait_for(lock, kAgain, [this] { return ending_; });
      continue;
    }
    wake_.wait_for(lock, kCheckPeriod, [this] { return ending_ || dirty_; });
    lock.unlock();
    check_processes();
    lock.lock();
  }
}

void BusGuard::check_processes() {
  std::map<std::string, std::string> processes;
  {
    const std::lock_guard lock(mutex_);
    processes = claims_.processes();
  }
  for (const auto& [id, process] : processes) {
    if (has_ended(process)) lost(id);
  }
}

}  // namespace fieldcast
