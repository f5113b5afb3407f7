// The interests of all clients of the station, as one station has them on DDS: one refresh for each
// pattern, the shortest that a client wishes, withdrawn with the last client. Pure; one owner, on
// the io thread.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <set>
#include <string>

#include "core/base/time.hpp"

namespace fieldcast::web {

class InterestBook {
 public:
  static constexpr std::size_t kMaxPatterns = 1024;

  // Called at each change: the refresh from now on; 0: the interest is withdrawn.
  using Declare = std::function<void(const std::string& pattern, Duration refresh)>;
  explicit InterestBook(Declare declare) : declare_(std::move(declare)) {}

  // False: too many patterns.
  [[nodiscard]] bool add(const std::string& pattern, Duration refresh);
  // REQUIRES: it was added with this refresh and not removed since.
  void remove(const std::string& pattern, Duration refresh);

  [[nodiscard]] std::size_t count() const { return wished_.size(); }

 private:
  const Declare declare_;
  std::map<std::string, std::multiset<Duration>> wished_;
};

}  // namespace fieldcast::web
