// Remembers which commands were seen, so that none runs twice: transports and operators repeat
// commands. Pure; one owner, who guards it if several threads use it. Nothing can fail; when it is
// full, the oldest key is forgotten.
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

  // True if this key was not among the last `remembered` keys: the command may run. False: it is a
  // duplicate. A duplicate does not make its key younger.
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
  // Oldest first; a deque never moves what it holds, so that the set may point into it.
  std::deque<Key> order_;
  std::unordered_set<const Key*, Hash, Equal> known_;
};

}  // namespace fieldcast
