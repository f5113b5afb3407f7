// Answers that are owed: a device that was asked N times and gave fewer answers may still give the
// others. Until they came, or can no longer come, nothing is asked whose answer one of them could
// be mistaken for.
//
// The protocol says which answers can be mistaken for each other (AnswerIdentity,
// Protocol::mistakable). The same read may be asked again while none of its answers has come, since
// any of them brings the same items; the answers that are then too many stay owed. A debt ends
//   - when its answer comes: devices answer in the order in which they were asked, so an answer
//     settles the oldest debt that it could belong to;
//   - when the device answers a later request that cannot be mistaken: what was asked before it is
//     never answered;
//   - by time: kLateFactor times the configured timeout, or twice the longest time that the device
//     was lately seen to take, whichever is longer (kMostFactor times the timeout at most). A
//     device works off its requests one after the other, so the time of each debt begins when the
//     one before it ended, but waits for two others at most.
//
// Owned by LateAnswers, on the bus's thread. Nothing can fail.
#pragma once

#include <algorithm>
#include <functional>
#include <optional>
#include <vector>

#include "core/dispatch/decision.hpp"
#include "core/protocol/protocol.hpp"

namespace fieldcast {

// One request on the wire.
struct Asked {
  DeviceIndex device = 0;
  Request request;
  ExchangeContext context;
  Instant sent_until{};  // its last character had left by then
};

class OwedAnswers {
 public:
  // A late answer can still come until this many configured timeouts after its request.
  static constexpr int kLateFactor = 3;
  static constexpr int kMostFactor = 10;     // however long its last answers took
  static constexpr std::size_t kMost = 256;  // debts of a bus; the oldest one is forgotten

  struct Debt {
    Asked asked;
    Duration bound{};
    Instant counts_until = kLongAgo;  // an answer until then is worth as much as one in time
    Block block;                      // whose values it brings, while somebody waits for them
    // What the answer before it took, if this one comes: nobody knew which of the two it was.
    Duration before{};
    std::unique_ptr<Exchange> exchange;  // recognises the answer; none: to be made anew
    // No answer to this read has come yet: asking it again makes nothing worse.
    bool unanswered = true;
    Instant began{};  // when its time began
    [[nodiscard]] Instant until() const { return began + bound; }
  };
  // Whether a late answer to the first could be taken for the answer to the second.
  using Mistakable = std::function<bool(const Asked& earlier, const Asked& later)>;
  explicit OwedAnswers(Mistakable mistakable) : mistakable_(std::move(mistakable)) {}

  void owe(Debt debt);
  // The request was answered. `refused`: by a refusal, which shows less of its origin.
  void answered(const Asked& asked, bool refused, Duration bound, Instant now);
  // Its answer has come after all.
  Debt take(std::size_t index, Instant now);
  // Forgets what can no longer come; true when there was any.
  bool expire(Instant now);
  void forget_all() { debts_.clear(); }
  // What comes from now on has nothing to do with what came before.
  void forget_bytes() {
    for (Debt& debt : debts_) debt.exchange.reset();
  }

  // From when on this may be asked, as things stand; kLongAgo: at once. `same_is_fine`: the same
  // read again does no harm.
  [[nodiscard]] Instant askable_from(const Asked& next, bool same_is_fine) const;
  [[nodiscard]] std::vector<Debt>& debts() { return debts_; }
  [[nodiscard]] bool empty() const { return debts_.empty(); }
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
  std::vector<Debt> debts_;  // in the order asked
};

// The same read of the same device: its answers bring the same items.
[[nodiscard]] bool same_read(const Asked& a, const Asked& b);

}  // namespace fieldcast
