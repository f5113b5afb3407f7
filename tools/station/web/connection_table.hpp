// Limits the connections of a server in total and for each address, with a reserve for logins.
// Pure; owns no connection.
//
// A connection waits for its client (next request, rest of a request, handshake) or works (the
// station makes or sends a response). Only a waiting connection can be closed for a new one.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>

#include "core/base/time.hpp"

namespace fieldcast::web {

struct ConnectionLimits {
  std::size_t total = 256;
  std::size_t of_one = 128;  // of one address; connections with a login are counted separately
  // of one address without a login; lower than of_one: a new one always fits
  std::size_t working_of_one = 96;
  std::size_t reserved = 64;  // part of `total` in which only connections with a login work
};

// Removes the port. IPv6 becomes its /64, because a host can use all of it; IPv4-mapped becomes
// IPv4. Other text is returned unchanged.
[[nodiscard]] std::string address_group(std::string_view address);

class ConnectionTable {
 public:
  using Id = std::uint64_t;  // given by the caller, never reused
  enum class Phase : std::uint8_t { kWaiting, kWorking };
  struct Peer {
    std::string group;  // result of address_group()
    bool logged_in = false;
  };
  struct Admission {
    bool admitted = false;
    std::optional<Id> evicted;  // removed from the table; the caller closes it
  };

  explicit ConnectionTable(const ConnectionLimits& limits) : limits_(limits) {}

  // Beyond a limit, evicts the connection that has waited longest: of the same address for its
  // limit, one without a login first for the total. Admits nothing if none waits, or if only the
  // reserve is left for work.
  [[nodiscard]] Admission open(Id id, Peer peer, Phase phase, Instant now);
  // Returns the same decision without a change.
  [[nodiscard]] Admission admission(const Peer& peer, Phase phase) const;
  // A complete request has arrived. If it is not admitted, the table is unchanged and the caller
  // refuses it. REQUIRES: `id` is in the table.
  [[nodiscard]] Admission work(Id id, bool logged_in);
  // The response has ended; no effect if `id` was removed.
  void wait(Id id, Instant now);
  void close(Id id);  // no effect if `id` was removed

  [[nodiscard]] std::size_t size() const { return rows_.size(); }

 private:
  struct Row {
    Peer peer;
    Phase phase = Phase::kWaiting;
    Instant since{};  // start of waiting
  };
  template <typename Rule>
  [[nodiscard]] std::size_t count(Rule rule) const;
  template <typename Rule>
  [[nodiscard]] std::optional<Id> oldest_waiting(Rule rule) const;
  [[nodiscard]] bool may_work(const Peer& peer) const;
  [[nodiscard]] Admission room_at_address(const Peer& peer, std::optional<Id> self) const;

  const ConnectionLimits limits_;
  std::map<Id, Row> rows_;
};

}  // namespace fieldcast::web
