// Which connections a server keeps, and which one leaves when there are too many: limits in all and
// for each address, with a reserve for logins. Pure: no socket, no clock. Owns no connection.
//
// A connection waits for its client (the next request, the rest of one, the handshake), or works
// (the station makes a response, or the client receives it). One that waits can be closed for a new
// one; one that works is never closed. Whether a login is valid is known when a request is whole.
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
  std::size_t of_one = 128;         // of one address; with and without a login are counted apart
  std::size_t working_of_one = 96;  // of them, without a login: a new one always finds room
  std::size_t reserved = 64;        // of `total`: only connections with a login work there
};

// The address without its port as its /64 for IPv6, since a host has as many addresses of it as it
// likes, and as IPv4 for one that is mapped to IPv6. Another text is returned as it is.
[[nodiscard]] std::string address_group(std::string_view address);

class ConnectionTable {
 public:
  using Id = std::uint64_t;  // given by the caller, never reused
  enum class Phase : std::uint8_t { kWaiting, kWorking };
  struct Peer {
    std::string group;  // address_group()
    bool logged_in = false;
  };
  struct Admission {
    bool admitted = false;
    std::optional<Id> evicted;  // left the table; the caller closes it
  };

  explicit ConnectionTable(const ConnectionLimits& limits) : limits_(limits) {}

  // Adds a connection. Beyond a limit, the one that has waited for longest leaves: of the same
  // address beyond the limit of that address, one without a login first beyond that of all. Not
  // admitted if none of them waits, or if only the reserve is left for work.
  [[nodiscard]] Admission open(Id id, Peer peer, Phase phase, Instant now);
  // The same decision, without a change.
  [[nodiscard]] Admission admission(const Peer& peer, Phase phase) const;
  // A whole request came, by this login or without one. Not admitted: it stays as it was, and the
  // caller refuses the request. REQUIRES: `id` is in the table.
  [[nodiscard]] Admission work(Id id, bool logged_in);
  // The response ended; no effect if `id` left the table.
  void wait(Id id, Instant now);
  void close(Id id);  // no effect if it left the table

  [[nodiscard]] std::size_t size() const { return rows_.size(); }

 private:
  struct Row {
    Peer peer;
    Phase phase = Phase::kWaiting;
    Instant since{};  // waits since then
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
