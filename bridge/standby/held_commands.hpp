// Commands at a waiting member of a standby group: it receives the same commands as the master,
// holds each one until it receives the result, and runs those that are left when it takes over. If
// the master has begun a write, its effect is unknown: without a result or the note that it was
// given back, it ends as failed and never runs again.
//
// A command may have reached only this member, before a later member became master. The member
// therefore reports commands without a result to the master, which responds to unknown ones and
// reports which already have a result. Any thread.
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
#include "core/bus/command/command_ledger.hpp"

namespace fieldcast {

// `Item`: a command with its bus, or an action of a user on an alarm.
template <class Item>
class HeldCommands {
 public:
  // More are not held and get no result from this member.
  static constexpr std::size_t kMost = 16384;
  // After a command's lifespan plus this time, no response of the master is expected.
  static constexpr Duration kLonger = std::chrono::seconds{10};
  // Commands without a result are reported to the master at this period, at most kMostTold times.
  static constexpr Duration kTellAfter = std::chrono::seconds{1};
  static constexpr unsigned kMostTold = 10;
  static constexpr std::size_t kMostAtOnce = 64;
  // The master remembers results this long, for late commands and members that join after one.
  static constexpr Duration kResultsFor = std::chrono::seconds{30};
  using Key = std::pair<std::string, std::uint64_t>;

  // Time that a new master waits for results of begun writes.
  static constexpr Duration kLastWords = std::chrono::milliseconds{250};

  struct Left {
    std::vector<Item> to_run;  // in the order of arrival
    struct Begun {
      std::string bus;
      Key key;
    };
    std::vector<Begun> begun;  // without a result
  };
  struct WithoutResult {
    std::string bus;
    Key key;
    bool begun = false;  // by this or the previous master
  };

  // Returns true if the command is held. False: this bridge is master and must run it.
  [[nodiscard]] bool hold(const std::string& bus, const Key& key, Item item, Instant expires,
                          Instant now) {
    const std::lock_guard lock(mutex_);
    if (open_ && !entries_.contains(key)) return false;
    expire(now);
    if (completed_.contains(key) || entries_.size() >= kMost) return true;
    Entry& entry = entries_[key];
    if (!entry.has_item) entry.number = ++last_;
    entry.item = std::move(item);
    entry.has_item = true;
    entry.bus = bus;
    entry.tell_at = std::min(entry.tell_at, now + kTellAfter);
    entry.until = expires == kNever ? kNever : expires + kLonger;
    return true;
  }
  // The master has begun the command. `until`: its result arrives before then, or never.
  void begun(const std::string& bus, const Key& key, Instant until) {
    const std::lock_guard lock(mutex_);
    if (open_ || completed_.contains(key) || entries_.size() >= kMost) return;
    Entry& entry = entries_[key];
    if (entry.number == 0) entry.number = ++last_;
    entry.begun = true;
    entry.bus = bus;
    entry.until = until;
  }
  // The master had begun the command and gave it back without effect.
  void returned(const Key& key) {
    const std::lock_guard lock(mutex_);
    if (const auto found = entries_.find(key); found != entries_.end()) found->second.begun = false;
  }
  void completed(const Key& key) {
    const std::lock_guard lock(mutex_);
    if (open_ && !entries_.contains(key)) return;
    entries_.erase(key);
    if (!completed_.insert(key).second) return;
    order_.push_back(key);
    if (order_.size() <= CommandLedger::kRemembered) return;
    completed_.erase(order_.front());
    order_.pop_front();
  }

  // Returns true if this bridge is master and holds nothing.
  [[nodiscard]] bool runs() const {
    const std::lock_guard lock(mutex_);
    return open_ && entries_.empty();
  }
  // Returns the commands to report now to the master of this term.
  [[nodiscard]] std::vector<WithoutResult> without_result(std::uint64_t term, Instant now) {
    const std::lock_guard lock(mutex_);
    std::vector<WithoutResult> found;
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

  // This bridge leaves its group. Returns commands without a result that no master has begun.
  [[nodiscard]] std::vector<WithoutResult> last_words(Instant now) {
    const std::lock_guard lock(mutex_);
    std::vector<WithoutResult> found;
    if (open_) return found;
    expire(now);
    for (const auto& [key, entry] : entries_) {
      if (entry.has_item && !entry.begun) found.push_back({entry.bus, key, false});
    }
    return found;
  }

  // This bridge becomes master. Returns the commands to run now. Begun commands stay held.
  [[nodiscard]] std::vector<Item> take_over(Instant now) {
    const std::lock_guard lock(mutex_);
    expire(now);
    open_ = true;
    return take_returned();
  }
  // After take_over(): returns true if a begun command has neither a result nor been given back.
  [[nodiscard]] bool waits() const {
    const std::lock_guard lock(mutex_);
    return open_ &&
           std::ranges::any_of(entries_, [](const auto& each) { return each.second.begun; });
  }
  // Call kLastWords after take_over(), or when waits() returns false. Returns the commands that
  // were given back, and the begun ones without a result. Afterwards nothing is held.
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
  // This bridge (re)joins its group: commands held until now never run here; new ones are held.
  void join() {
    const std::lock_guard lock(mutex_);
    entries_.clear();
    open_ = false;
  }
  // Another bridge is or becomes master; new commands are held.
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
  bool open_ = true;  // a bridge without a group runs everything
  std::map<Key, Entry> entries_;
  std::set<Key> completed_;
  std::deque<Key> order_;
  std::uint64_t last_ = 0;
  std::uint64_t term_ = 0;
  Instant look_ = kLongAgo;
};

}  // namespace fieldcast
