// Detects repeated commands. Drops the oldest key when full. The owner guards it between threads.
#pragma once

#include <cstdint>
#include <deque>
#include <string>
#include <string_view>
#include <unordered_set>
#include <utility>

namespace fieldcast {

class CommandLedger {
 public:
  static constexpr std::size_t kRemembered = 65536;

  explicit CommandLedger(std::size_t remembered = kRemembered) : remembered_(remembered) {}

  // Returns false for a duplicate among the last `remembered` keys; it does not renew its key.
  [[nodiscard]] bool enter(std::string_view requester, std::uint64_t request_id);

  [[nodiscard]] std::size_t size() const { return order_.size(); }

 private:
  using Key = std::pair<std::string, std::uint64_t>;
  struct Hash {
    std::size_t operator()(const Key* key) const;
  };
  struct Equal {
    bool operator()(const Key* a, const Key* b) const { return *a == *b; }
  };

  std::size_t remembered_;
  // Oldest first. A deque keeps element addresses stable, so the set can point into it.
  std::deque<Key> order_;
  std::unordered_set<const Key*, Hash, Equal> known_;
};

}  // namespace fieldcast
