// Commands at a waiting member of a standby group: it receives what the master receives, and holds
// it until the result is seen. When it takes over it knows which ones are still to be run.
//
// Of a write that the master has begun nobody knows whether it took effect. Its result may still be
// on its way, or the word that it was given back; without either it is answered as failed, and
// never run again.
//
// A command may have reached this member alone: it came while the group had no master, and another
// one became master that was not there yet. So the master is told of what has no result for a
// while; it answers what it does not know, and says of what has its result that it has. Any thread.
#pragma once

#include <algorithm>
#include <cstdint>
#include <deque>
#include <map>
#include <mutex>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "core/base/time.hpp"
#include "core/bus/command_ledger.hpp"

namespace fieldcast {

// `Item`: a command with its bus, or what a person does about an alarm.
template <class Item>
class HeldCommands {
 public:
  static constexpr std::size_t kMost = 16384;  // more are not held: they have no result then
  // After its lifespan the master has answered, or nobody will.
  static constexpr Duration kLonger = std::chrono::seconds{10};
  // A master has told the result of most commands by then; it is told of the others, so often.
  static constexpr Duration kTellAfter = std::chrono::seconds{1};
  static constexpr unsigned kMostTold = 10;
  static constexpr std::size_t kMostAtOnce = 64;
  // The master knows so long that a command has its result: whoever holds one may have received it
  // late, and joined the group behind its result.
  static constexpr Duration kAnswersFor = std::chrono::seconds{30};
  using Key = std::pair<std::string, std::uint64_t>;  // requester, request_id

  // How long a new master waits for that.
  static constexpr Duration kLastWords = std::chrono::milliseconds{250};

  struct Left {
    std::vector<Item> to_run;  // in the order in which they came
    struct Begun {
      std::string bus;
      Key key;
    };
    std::vector<Begun> begun;  // without a result
  };
  struct Unanswered {
    std::string bus;
    Key key;
    bool begun = false;  // by this master or the one before
  };

  // True: it is held. False: this bridge is master, and it is to be run.
  [[nodiscard]] bool hold(const std::string& bus, const Key& key, Item item, Instant expires,
                          Instant now) {
    const std::lock_guard lock(mutex_);
    if (open_ && !entries_.contains(key)) return false;
    expire(now);
    if (answered_.contains(key) || entries_.size() >= kMost) return true;
    Entry& entry = entries_[key];
    if (!entry.has_item) entry.number = ++last_;
    entry.item = std::move(item);
    entry.has_item = true;
    entry.bus = bus;
    entry.tell_at = std::min(entry.tell_at, now + kTellAfter);
    entry.until = expires == kNever ? kNever : expires + kLonger;
    return true;
  }
  // The master has begun it. `until`: its result comes before, or never.
  void begun(const std::string& bus, const Key& key, Instant until) {
    const std::lock_guard lock(mutex_);
    if (open_ || answered_.contains(key) || entries_.size() >= kMost) return;
    Entry& entry = entries_[key];
    if (entry.number == 0) entry.number = ++last_;
    entry.begun = true;
    entry.bus = bus;
    entry.until = until;
  }
  // The master had begun it, and it had no effect.
  void returned(const Key& key) {
    const std::lock_guard lock(mutex_);
    if (const auto found = entries_.find(key); found != entries_.end()) found->second.begun = false;
  }
  void answered(const Key& key) {
    const std::lock_guard lock(mutex_);
    if (open_ && !entries_.contains(key)) return;
    entries_.erase(key);
    if (!answered_.insert(key).second) return;
    order_.push_back(key);
    if (order_.size() <= CommandLedger::kRemembered) return;
    answered_.erase(order_.front());
    order_.pop_front();
  }

  // This bridge is master, and nothing is held.
  [[nodiscard]] bool runs() const {
    const std::lock_guard lock(mutex_);
    return open_ && entries_.empty();
  }
  // What the master of this term is to be told of now: it may never have received it.
  [[nodiscard]] std::vector<Unanswered> unanswered(std::uint64_t term, Instant now) {
    const std::lock_guard lock(mutex_);
    std::vector<Unanswered> found;
    if (open_) return found;
    expire(now);
    if (std::exchange(term_, term) != term) {
      for (auto& [key, entry] : entries_) {
        entry.tell_at = now + kTellAfter;
        entry.told = 0;
      }
    }
    for (auto& [key, entry] : entries_) {
      if (entry.tell_at > now || entry.told >= kMostTold) continue;
      if (found.size() == kMostAtOnce) break;
      ++entry.told;
      entry.tell_at = now + kTellAfter;
      found.push_back({entry.bus, key, entry.begun});
    }
    return found;
  }

  // This bridge leaves its group: what it alone may have received, and no master has begun.
  [[nodiscard]] std::vector<Unanswered> last_words(Instant now) {
    const std::lock_guard lock(mutex_);
    std::vector<Unanswered> found;
    if (open_) return found;
    expire(now);
    for (const auto& [key, entry] : entries_) {
      if (entry.has_item && !entry.begun) found.push_back({entry.bus, key, false});
    }
    return found;
  }

  // This bridge is master from here on: what runs now. What was begun is waited for.
  [[nodiscard]] std::vector<Item> take_over(Instant now) {
    const std::lock_guard lock(mutex_);
    expire(now);
    open_ = true;
    return take_returned();
  }
  // After take_over(): something begun has neither a result nor been given back.
  [[nodiscard]] bool waits() const {
    const std::lock_guard lock(mutex_);
    return open_ &&
           std::ranges::any_of(entries_, [](const auto& each) { return each.second.begun; });
  }
  // kLastWords after take_over(), or when nothing is waited for any more: what was given back, and
  // what nobody has answered. Nothing is held from here on.
  [[nodiscard]] Left give_up() {
    const std::lock_guard lock(mutex_);
    Left left;
    if (!open_) return left;
    left.to_run = take_returned();
    for (const auto& [key, entry] : entries_) {
      if (entry.begun) left.begun.push_back({entry.bus, key});
    }
    entries_.clear();
    return left;
  }
  // This bridge joins its group, perhaps once more: results that were told before it could hear
  // them are unknown to it, so what it held by then is not run any more. What comes is held.
  void join() {
    const std::lock_guard lock(mutex_);
    entries_.clear();
    open_ = false;
  }
  // Another bridge is master, or will be: what comes is held.
  void stand_by() {
    const std::lock_guard lock(mutex_);
    open_ = false;
  }
  [[nodiscard]] std::size_t size() const {
    const std::lock_guard lock(mutex_);
    return entries_.size();
  }

 private:
  struct Entry {
    Item item{};
    bool has_item = false;
    bool begun = false;
    std::string bus;
    std::uint64_t number = 0;
    Instant until = kNever;
    Instant tell_at = kNever;
    unsigned told = 0;  // to the master of term_
  };
  std::vector<Item> take_returned() {
    std::map<std::uint64_t, Item> in_order;
    std::erase_if(entries_, [&](auto& each) {
      auto& [key, entry] = each;
      if (entry.begun) return false;
      if (entry.has_item) in_order.emplace(entry.number, std::move(entry.item));
      return true;
    });
    std::vector<Item> taken;
    for (auto& [number, item] : in_order) taken.push_back(std::move(item));
    return taken;
  }
  void expire(Instant now) {
    if (now < look_) return;
    look_ = now + std::chrono::seconds{1};
    std::erase_if(entries_, [now](const auto& entry) { return entry.second.until <= now; });
  }

  mutable std::mutex mutex_;
  bool open_ = true;  // a bridge that stands alone runs everything
  std::map<Key, Entry> entries_;
  std::set<Key> answered_;
  std::deque<Key> order_;
  std::uint64_t last_ = 0;
  std::uint64_t term_ = 0;
  Instant look_ = kLongAgo;
};

}  // namespace fieldcast
