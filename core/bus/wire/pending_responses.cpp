#include "core/bus/wire/pending_responses.hpp"

namespace fieldcast {

bool same_read(const Asked& a, const Asked& b) {
  const auto* x = std::get_if<ReadRequest>(&a.request);
  const auto* y = std::get_if<ReadRequest>(&b.request);
  return x != nullptr && y != nullptr && a.device == b.device && x->ranges == y->ranges;
}

void PendingResponses::owe(Debt debt) {
  Instant before = debt.asked.sent_until;
  for (const Debt& other : debts_) {
    if (other.asked.device == debt.asked.device) before = std::max(before, other.until());
  }
  debt.began = begin_behind(debt, before, debt.asked.sent_until);
  if (debts_.size() == kMost) debts_.erase(debts_.begin());
  debts_.push_back(std::move(debt));
}

void PendingResponses::begin_next(DeviceIndex device, Instant now) {
  Instant from = now;
  for (Debt& debt : debts_) {
    if (debt.asked.device != device) continue;
    debt.began = begin_behind(debt, from, now);
    from = debt.until();
  }
}

void PendingResponses::responded(const Asked& asked, bool refused, Duration bound, Instant now) {
  if (debts_.empty()) return;
  const auto oldest = std::find_if(debts_.begin(), debts_.end(), [&](const Debt& debt) {
    return mistakable_(debt.asked, asked);
  });
  if (oldest != debts_.end()) {
    // The response may belong to the removed debt; then the request's own one is still pending.
    const DeviceIndex device = oldest->asked.device;
    const Duration took = now - oldest->asked.sent_until;
    debts_.erase(oldest);
    begin_next(device, now);
    for (Debt& debt : debts_) {
      if (!same_read(debt.asked, asked)) continue;
      debt.block = {};
      debt.no_response = false;
    }
    Debt own;
    own.asked = asked;
    own.bound = bound;
    own.before = took;
    own.no_response = false;
    owe(std::move(own));
    return;
  }
  if (refused) return;
  std::erase_if(debts_, [&](const Debt& debt) { return debt.asked.device == asked.device; });
}

PendingResponses::Debt PendingResponses::take(std::size_t index, Instant now) {
  Debt debt = std::move(debts_[index]);
  const auto at = debts_.begin() + static_cast<std::ptrdiff_t>(index);
  const auto skipped = [&](const Debt& before) {
    return before.asked.device == debt.asked.device && !mistakable_(before.asked, debt.asked);
  };
  debts_.erase(std::remove_if(debts_.begin(), at, skipped), at + 1);
  begin_next(debt.asked.device, now);
  return debt;
}

bool PendingResponses::expire(Instant now) {
  return std::erase_if(debts_, [&](const Debt& debt) { return debt.until() <= now; }) > 0;
}

bool PendingResponses::owes_same(const Asked& asked) const {
  return std::any_of(debts_.begin(), debts_.end(),
                     [&](const Debt& debt) { return same_read(debt.asked, asked); });
}

Instant PendingResponses::askable_from(const Asked& next, bool same_is_fine) const {
  Instant from = kLongAgo;
  for (const Debt& debt : debts_) {
    if (same_is_fine && debt.no_response && same_read(debt.asked, next)) continue;
    if (mistakable_(debt.asked, next)) from = std::max(from, debt.until());
  }
  return from;
}

}  // namespace fieldcast
