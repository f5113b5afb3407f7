#include "bridge/interest_desk.hpp"

namespace fieldcast {

void InterestDesk::add(const BusSpec& bus, std::shared_ptr<BusRunner> runner) {
  const std::lock_guard lock(mutex_);
  tell(buses_[bus.name] = Bus{bus, std::move(runner), {}});
}

void InterestDesk::remove(const std::string& bus) {
  const std::lock_guard lock(mutex_);
  buses_.erase(bus);
}

void InterestDesk::forget() {
  const std::lock_guard lock(mutex_);
  book_ = {};
  for (auto& [name, bus] : buses_) tell(bus);
}

tl::expected<void, std::string> InterestDesk::note(const std::string& station, const std::string& pattern,
                                                   std::optional<Duration> refresh) {
  const std::lock_guard lock(mutex_);
  auto noted = book_.note(station, pattern, refresh);
  if (!noted) return noted;
  for (auto& [name, bus] : buses_) tell(bus);
  return {};
}

void InterestDesk::tell(Bus& bus) {
  auto wishes = book_.wishes(bus.spec);
  auto changed = changes(bus.told, wishes);
  if (!changed.empty()) bus.runner->post(std::move(changed));
  bus.told = std::move(wishes);
}

}  // namespace fieldcast
