// Slows guessing down: after a few wrong passwords each further one makes the next attempt wait, 1
// s, 2 s, 4 s .. 5 min. Nobody sleeps for it: an attempt that comes too early is turned away
// unread, and costs nothing. Pure; one owner.
//
// A user from one peer is one key, so that strangers who guess elsewhere do not lock the user out;
// and a peer that tries many users is another, with more patience.
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
  static constexpr std::size_t kMaxKeys =
      4096;  // the one that is quiet for longest is forgotten for a new one

  // How long the next attempt has to wait; zero: it may come.
  [[nodiscard]] Duration wait(std::string_view user, std::string_view peer, Instant now) const;
  void failed(std::string_view user, std::string_view peer, Instant now);
  // The user's count of this peer starts anew; the peer's own does not, or one good account would
  // let it guess all others.
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
