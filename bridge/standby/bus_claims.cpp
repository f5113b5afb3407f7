#include "bridge/standby/bus_claims.hpp"

#include <algorithm>
#include <cstdint>
#include <tuple>

namespace fieldcast {
namespace {

// A smaller rank has priority.
auto rank(const BusClaim& claim, const std::string& id) {
  return std::tuple(!claim.serving, claim.since, id);
}

}  // namespace

void BusClaims::receive(const std::string& id, BridgeClaims claims) {
  others_[id] = {std::move(claims), true};
}

void BusClaims::set_alive(const std::string& id, bool alive) {
  if (const auto other = others_.find(id); other != others_.end()) other->second.alive = alive;
}

void BusClaims::forget(const std::string& id) { others_.erase(id); }

std::map<std::string, std::string> BusClaims::processes() const {
  std::map<std::string, std::string> processes;
  for (const auto& [id, other] : others_) {
    if (other.alive) processes[id] = other.claims.process;
  }
  return processes;
}

void BusClaims::want(const std::vector<std::string>& buses, UtcTime now) {
  std::erase_if(own_, [&](const auto& claim) {
    return std::find(buses.begin(), buses.end(), claim.first) == buses.end();
  });
  std::erase_if(unserved_, [&](const auto& entry) { return !own_.contains(entry.first); });
  for (const std::string& bus : buses) own_.try_emplace(bus, BusClaim{now, false});
}

std::optional<BridgeClaims> BusClaims::rival(const std::string& bus) const {
  const BusClaim& own = own_.at(bus);
  auto first = own.serving ? rank({UtcTime{INT64_MIN}, false}, {}) : rank(own, id_);
  const BridgeClaims* found = nullptr;
  for (const auto& [id, other] : others_) {
    const auto claim = other.claims.buses.find(bus);
    if (!is_rival(other) || claim == other.claims.buses.end()) continue;
    if (const auto its = rank(claim->second, id); its < first) {
      first = its;
      found = &other.claims;
    }
  }
  return found == nullptr ? std::nullopt : std::optional(*found);
}

bool BusClaims::decide(Instant now) {
  bool changed = false;
  for (auto& [bus, claim] : own_) {
    const auto first = rival(bus);
    if (!first || first->buses.at(bus).serving) unserved_.erase(bus);
    // Also counted while this bridge stands by: a takeover must not wait for it.
    const bool unserved = first && !first->buses.at(bus).serving &&
                          now - unserved_.try_emplace(bus, now).first->second >= kMostUnserved;
    const bool serving = !standing_by_ && (claim.serving || !first || unserved);
    changed |= serving != claim.serving;
    claim.serving = serving;
  }
  return changed;
}

bool BusClaims::serves(const std::string& bus) const {
  const auto claim = own_.find(bus);
  return claim != own_.end() && claim->second.serving;
}

std::set<std::string> BusClaims::contested() const {
  std::set<std::string> found;
  for (const auto& [bus, claim] : own_) {
    if (claim.serving && rival(bus)) found.insert(bus);
  }
  return found;
}

bool BusClaims::are_wanted_elsewhere() const {
  return std::ranges::any_of(others_, [this](const auto& entry) {
    const Other& other = entry.second;
    return other.alive && std::ranges::any_of(other.claims.buses, [this](const auto& claim) {
             return own_.contains(claim.first);
           });
  });
}

std::optional<BusClaims::Namesake> BusClaims::namesake(const BridgeClaims& own) const {
  const auto order = [](const BridgeClaims& claims, const std::string& id) {
    const bool serves =
        std::ranges::any_of(claims.buses, [](const auto& entry) { return entry.second.serving; });
    return std::tuple(!serves, claims.since, id);
  };
  for (const auto& [id, other] : others_) {
    if (!other.alive || group_.empty() || other.claims.group != group_) continue;
    const bool itself = !own.process.empty() && other.claims.process == own.process;
    if (itself || other.claims.bridge != own.bridge) continue;
    return Namesake{other.claims, order(other.claims, id) < order(own, id_)};
  }
  return std::nullopt;
}

std::size_t BusClaims::members_beside(const std::vector<std::string>& bridges) const {
  return static_cast<std::size_t>(std::ranges::count_if(others_, [&](const auto& entry) {
    const Other& other = entry.second;
    return other.alive && !group_.empty() && other.claims.group == group_ &&
           std::ranges::find(bridges, other.claims.bridge) == bridges.end();
  }));
}

}  // namespace fieldcast
