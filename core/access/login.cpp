#include "core/access/login.hpp"

#include <algorithm>

#include "core/access/network.hpp"

namespace fieldcast {

std::string_view to_text(Role role) {
  switch (role) {
    case Role::kViewer: return "viewer";
    case Role::kOperator: return "operator";
    case Role::kProgrammer: return "programmer";
    case Role::kEngineer: return "engineer";
  }
  return "?";
}

std::optional<Role> role_from(std::string_view text) {
  for (const Role role : kRoles) {
    if (text == to_text(role)) return role;
  }
  return std::nullopt;
}

namespace {

std::string key_of(std::string_view peer) { return access::address_group(peer); }

// Names of users and addresses of peers contain no line feed, so keys are unambiguous.
std::string key_of(std::string_view user, std::string_view peer) {
  return key_of(peer) + '\n' + std::string(user);
}

}  // namespace

Duration LoginThrottle::wait(std::string_view user, std::string_view peer, Instant now) const {
  return std::max(wait_of(key_of(user, peer), now), wait_of(key_of(peer), now));
}

void LoginThrottle::failed(std::string_view user, std::string_view peer, Instant now) {
  note(key_of(user, peer), kFreeOfUser, now);
  note(key_of(peer), kFreeOfPeer, now);
}

void LoginThrottle::succeeded(std::string_view user, std::string_view peer) {
  counts_.erase(key_of(user, peer));
}

void LoginThrottle::note(const std::string& key, unsigned free, Instant now) {
  auto found = counts_.find(key);
  if (found == counts_.end()) {
    if (counts_.size() == kMaxKeys) {
      counts_.erase(std::min_element(
          counts_.begin(), counts_.end(),
          [](const auto& a, const auto& b) { return a.second.last < b.second.last; }));
    }
    found = counts_.emplace(key, Count{}).first;
  }
  Count& count = found->second;
  if (now - count.last >= kForget) count.failures = 0;
  count.last = now;
  ++count.failures;
  if (count.failures < free) return;
  const unsigned doublings = std::min(count.failures - free, 16u);
  count.open = now + std::min(kFirst * (1 << doublings), kLongest);
}

Duration LoginThrottle::wait_of(const std::string& key, Instant now) const {
  const auto found = counts_.find(key);
  if (found == counts_.end() || found->second.open <= now) return Duration{};
  return found->second.open - now;
}

}  // namespace fieldcast
