#include "tools/station/web/connection_table.hpp"

#include <arpa/inet.h>
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <utility>

#include "bridge/base/check.hpp"

namespace fieldcast::web {
namespace {

constexpr std::array<unsigned char, 12> kMapped{0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0xFF, 0xFF};

}  // namespace

std::string address_group(std::string_view address) {
  std::string text(address);
  if (text.starts_with('[') && text.ends_with(']')) text = text.substr(1, text.size() - 2);
  text = text.substr(0, text.find('%'));
  std::array<unsigned char, 16> bytes;
  if (::inet_pton(AF_INET6, text.c_str(), bytes.data()) != 1) return text;
  if (std::equal(kMapped.begin(), kMapped.end(), bytes.begin()))
    return fmt::format("{}.{}.{}.{}", bytes[12], bytes[13], bytes[14], bytes[15]);
  std::fill(bytes.begin() + 8, bytes.end(), static_cast<unsigned char>(0));
  std::array<char, INET6_ADDRSTRLEN> prefix{};
  ::inet_ntop(AF_INET6, bytes.data(), prefix.data(), prefix.size());
  return std::string(prefix.data()) + "/64";
}

template <typename Rule>
std::size_t ConnectionTable::count(Rule rule) const {
  return static_cast<std::size_t>(
      std::ranges::count_if(rows_, [&](const auto& each) { return rule(each.second); }));
}

template <typename Rule>
std::optional<ConnectionTable::Id> ConnectionTable::oldest_waiting(Rule rule) const {
  auto oldest = rows_.end();
  for (auto at = rows_.begin(); at != rows_.end(); ++at) {
    if (at->second.phase != Phase::kWaiting || !rule(at->first, at->second)) continue;
    if (oldest == rows_.end() || at->second.since < oldest->second.since) oldest = at;
  }
  return oldest == rows_.end() ? std::nullopt : std::optional(oldest->first);
}

bool ConnectionTable::may_work(const Peer& peer) const {
  if (peer.logged_in) return true;
  const auto works = [](const Row& row) {
    return row.phase == Phase::kWorking && !row.peer.logged_in;
  };
  const auto works_there = [&](const Row& row) {
    return works(row) && row.peer.group == peer.group;
  };
  return count(works) + limits_.reserved < limits_.total &&
         count(works_there) < limits_.working_of_one;
}

// `self`: the connection to admit, if it is in the table already.
ConnectionTable::Admission ConnectionTable::room_at_address(const Peer& peer,
                                                            std::optional<Id> self) const {
  const auto is_alike = [&](const Row& row) {
    return row.peer.group == peer.group && row.peer.logged_in == peer.logged_in;
  };
  if (count(is_alike) < limits_.of_one) return {true, std::nullopt};
  const auto evicted =
      oldest_waiting([&](Id id, const Row& row) { return id != self && is_alike(row); });
  return {evicted.has_value(), evicted};
}

ConnectionTable::Admission ConnectionTable::admission(const Peer& peer, Phase phase) const {
  if (phase == Phase::kWorking && !may_work(peer)) return {};
  Admission room = room_at_address(peer, std::nullopt);
  if (!room.admitted || room.evicted || rows_.size() < limits_.total) return room;
  room.evicted = oldest_waiting([](Id, const Row& row) { return !row.peer.logged_in; });
  if (!room.evicted) room.evicted = oldest_waiting([](Id, const Row&) { return true; });
  room.admitted = room.evicted.has_value();
  return room;
}

ConnectionTable::Admission ConnectionTable::open(Id id, Peer peer, Phase phase, Instant now) {
  const Admission room = admission(peer, phase);
  if (room.evicted) rows_.erase(*room.evicted);
  if (room.admitted) rows_.emplace(id, Row{std::move(peer), phase, now});
  return room;
}

ConnectionTable::Admission ConnectionTable::work(Id id, bool logged_in) {
  const auto at = rows_.find(id);
  FIELDCAST_CHECK(at != rows_.end());
  Row& row = at->second;
  const Peer peer{row.peer.group, logged_in};
  if (!may_work(peer)) return {};
  Admission room{true, std::nullopt};
  if (row.peer.logged_in != logged_in) room = room_at_address(peer, id);
  if (!room.admitted) return room;
  if (room.evicted) rows_.erase(*room.evicted);
  row.peer.logged_in = logged_in;
  row.phase = Phase::kWorking;
  return room;
}

void ConnectionTable::wait(Id id, Instant now) {
  const auto at = rows_.find(id);
  if (at == rows_.end()) return;
  at->second.phase = Phase::kWaiting;
  at->second.since = now;
}

void ConnectionTable::close(Id id) { rows_.erase(id); }

}  // namespace fieldcast::web
