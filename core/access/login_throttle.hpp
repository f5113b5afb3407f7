// Slows down the guessing of passwords: after a few wrong ones each further one makes the next
// attempt wait, 1 s, 2 s, 4 s .. 5 min. No thread sleeps for it: an attempt that comes too early is
// refused, and its password is not checked. Pure; one owner.
//
// Failures are counted for a user from one peer, so that strangers who guess elsewhere do not lock
// the user out. They are also counted for the peer, with a higher limit: it may try many users.
#pragma once

#include <cstddef>
#include <map>
#include <string>
#include <string_view>

#include "core/base/time.hpp"

namespace fieldcast {

class LoginThrottle {
 public:
  static constexpr unsigned kFreeOfUser = 3;  // wrong passwords before the first wait
  static constexpr unsigned kFreeOfPeer = 10;
  static constexpr Duration kFirst = std::chrono::seconds{1};
  static constexpr Duration kLongest = std::chrono::minutes{5};
  static constexpr Duration kForget = std::chrono::minutes{30};  // without a wrong password
  // Beyond it, the key without a failure for longest is forgotten.
  static constexpr std::size_t kMaxKeys = 4096;

  // How long the next attempt has to wait; zero: it may come.
  [[nodiscard]] Duration wait(std::string_view user, std::string_view peer, Instant now) const;
  void failed(std::string_view user, std::string_view peer, Instant now);
  // The user's count of this peer starts anew. The peer's own count goes on: otherwise one good
  // account would let it guess all others.
  void succeeded(std::string_view user, std::string_view peer);

 private:
  struct Count {
    unsigned failures = 0;
    Instant last{};
    Instant open{};  // when the next attempt may come
  };
  void note(const std::string& key, unsigned free, Instant now);
  [[nodiscard]] Duration wait_of(const std::string& key, Instant now) const;

  std::map<std::string, Count> counts_;
};

}  // namespace fieldcast
