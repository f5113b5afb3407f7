// Limits the connections of a server in total and per address, with a reserve for logins. Pure. A
// connection waits for its client (request, handshake) or works (the server makes or sends a
// response). A waiting one can be closed for a new one; a working one only with `evicts_working`.
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
  std::size_t reserved = 64;    // part of `total` in which only connections with a login work
  bool evicts_working = false;  // if none waits
};

class ConnectionTable {
 public:
  using Id = std::uint64_t;  // given by the caller, never reused
  enum class Phase : std::uint8_t { kWaiting, kWorking };
  struct Peer {
    std::string group;  // result of access::address_group()
    bool logged_in = false;
  };
  struct Admission {
    bool admitted = false;
    std::optional<Id> evicted;  // removed from the table; the caller closes it
  };

  explicit ConnectionTable(const ConnectionLimits& limits) : limits_(limits) {}

  // Beyond a limit, evicts the connection that has waited longest: of the same address for its
  // limit, one without a login first for the total. Admits nothing if none may be evicted, or if
  // only the reserve is left for work.
  [[nodiscard]] Admission open(Id id, Peer peer, Phase phase, Instant now);
  // Returns the same decision without a change.
  [[nodiscard]] Admission admission(const Peer& peer, Phase phase) const;
  // A complete request. If it is not admitted, nothing changes. REQUIRES: `id` is in the table.
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
  [[nodiscard]] std::optional<Id> oldest(Phase phase, Rule rule) const;
  [[nodiscard]] bool may_work(const Peer& peer) const;
  [[nodiscard]] Admission place_at_address(const Peer& peer, std::optional<Id> self) const;

  const ConnectionLimits limits_;
  std::map<Id, Row> rows_;
};

// Checks a request header before the parser. Refuses what a proxy could parse differently
// (RFC 9112, 2.2, 5.1, 5.2, 6.1, 6.3): the body could then smuggle a second request. Pure.
struct HeadFault {
  unsigned status = 400;
  std::string_view error, hint;
};

class HeadCheck {
 public:
  // `all`: all received bytes of the request. Returns the first fault, which is final.
  [[nodiscard]] std::optional<HeadFault> put(std::string_view all);
  // Size of the header with its empty line; 0 while it is incomplete.
  [[nodiscard]] std::size_t size() const { return size_; }

 private:
  [[nodiscard]] std::optional<HeadFault> on_line(std::string_view line);
  [[nodiscard]] std::optional<HeadFault> on_length(std::string_view value);
  [[nodiscard]] std::optional<HeadFault> on_coding(std::string_view value);

  // next_: the next byte; line_: the start of its line
  std::size_t next_ = 0, line_ = 0, size_ = 0;
  bool first_ = true, has_length_ = false, has_coding_ = false, old_ = false;
};

}  // namespace fieldcast::web
