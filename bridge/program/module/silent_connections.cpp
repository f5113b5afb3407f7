#include "bridge/program/module/silent_connections.hpp"

#include <algorithm>
#include <utility>

namespace fieldcast::program {

SilentConnections::Id SilentConnections::add(const std::string& host, Cut cut) {
  const auto same = of_.find(host);
  if (same != of_.end() && same->second >= most_of_one_) {
    cut_oldest_of(host);
  } else if (all_.size() >= most_) {
    cut_one();
  }
  all_.emplace(++last_, Connection{host, std::move(cut)});
  ++of_[host];
  return last_;
}

bool SilentConnections::remove(Id id) {
  const auto found = all_.find(id);
  if (found == all_.end()) return false;
  const auto host = of_.find(found->second.host);
  if (--host->second == 0) of_.erase(host);
  all_.erase(found);
  return true;
}

bool SilentConnections::cut_one() {
  std::size_t most = 0;
  for (const auto& [host, count] : of_) most = std::max(most, count);
  const auto victim = std::find_if(all_.begin(), all_.end(),
                                   [&](const auto& one) { return of_[one.second.host] == most; });
  if (victim == all_.end()) return false;
  cut(victim);
  return true;
}

void SilentConnections::cut_oldest_of(const std::string& host) {
  cut(std::find_if(all_.begin(), all_.end(),
                   [&](const auto& one) { return one.second.host == host; }));
}

void SilentConnections::cut(std::map<Id, Connection>::iterator which) {
  const Cut cut = std::move(which->second.cut);
  remove(which->first);
  cut();
}

}  // namespace fieldcast::program
