// Pending responses: a device that received N requests and sent fewer responses may still send the
// others. Until they arrive or expire, no request is sent whose response could be confused with one
// of them.
//
// The protocol defines which responses are alike (ResponseIdentity, Protocol::mistakable). The same
// read may be repeated while none of its responses has arrived, since all contain the same items;
// surplus responses stay pending. A debt ends
//   - when its response arrives: devices respond in request order, so a response settles the oldest
//     debt that it matches;
//   - when the device responds to a later request that cannot be confused: it will never respond to
//     earlier ones;
//   - by time: after kLateFactor configured timeouts, or twice the longest recent response time if
//     longer, at most kMostFactor timeouts. A device handles its requests one by one, so the time
//     of a debt starts when the previous debt ends, but waits for at most two others.
//
// Owned by LateResponseFilter, on the bus's thread.
#pragma once

#include <algorithm>
#include <functional>
#include <optional>
#include <vector>

#include "core/dispatch/policy/decision.hpp"
#include "core/protocol/protocol.hpp"

namespace fieldcast {

struct Asked {
  DeviceIndex device = 0;
  Request request;
  ExchangeContext context;
  Instant sent_until{};  // latest time at which its last character left
};

class PendingResponses {
 public:
  // Configured timeouts after which a late response is no longer possible.
  static constexpr int kLateFactor = 3;
  static constexpr int kMostFactor = 10;     // upper limit, even for slower responses
  static constexpr std::size_t kMost = 256;  // debts of a bus; the oldest is dropped

  struct Debt {
    Asked asked;
    Duration bound{};
    Instant counts_until = kLongAgo;  // until then the response counts as in time
    Block block;                      // the values it contains, while they are needed
    // Time of the previous response, as the two could not be distinguished.
    Duration before{};
    std::unique_ptr<Exchange> exchange;  // recognises the response; created on demand
    // This read has no response yet, so it may be repeated.
    bool no_response = true;
    Instant began{};
    [[nodiscard]] Instant until() const { return began + bound; }
  };
  using Mistakable = std::function<bool(const Asked& earlier, const Asked& later)>;
  explicit PendingResponses(Mistakable mistakable) : mistakable_(std::move(mistakable)) {}

  void owe(Debt debt);
  // `refused`: the response was a refusal, which identifies its request less.
  void responded(const Asked& asked, bool refused, Duration bound, Instant now);
  // The late response of this debt arrived.
  Debt take(std::size_t index, Instant now);
  bool expire(Instant now);
  void forget_all() { debts_.clear(); }
  void forget_bytes() {
    for (Debt& debt : debts_) debt.exchange.reset();
  }

  // Earliest time to send, or kLongAgo. `same_is_fine`: ignores responses to the same read.
  [[nodiscard]] Instant askable_from(const Asked& next, bool same_is_fine) const;
  [[nodiscard]] std::vector<Debt>& debts() { return debts_; }
  [[nodiscard]] bool empty() const { return debts_.empty(); }
  [[nodiscard]] bool owes(DeviceIndex device) const {
    return std::ranges::any_of(debts_,
                               [&](const Debt& debt) { return debt.asked.device == device; });
  }
  [[nodiscard]] Instant until() const {
    Instant last = kLongAgo;
    for (const Debt& debt : debts_) last = std::max(last, debt.until());
    return last;
  }
  [[nodiscard]] bool owes_same(const Asked& asked) const;

 private:
  void begin_next(DeviceIndex device, Instant now);
  [[nodiscard]] static Instant begin_behind(const Debt& debt, Instant before, Instant now) {
    const Instant earliest = std::max(debt.asked.sent_until, now);
    return std::clamp(before, earliest, earliest + 2 * debt.bound);
  }

  Mistakable mistakable_;
  std::vector<Debt> debts_;  // in order of the requests
};

// The same read of the same device: its responses contain the same items.
[[nodiscard]] bool same_read(const Asked& a, const Asked& b);

}  // namespace fieldcast
