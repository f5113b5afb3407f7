// Merges the clients' interests: each pattern has the shortest requested refresh on DDS and is
// withdrawn with its last client. Pure; on the io thread.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <set>
#include <string>

#include "core/base/time.hpp"

namespace fieldcast::web {

class ClientInterests {
 public:
  static constexpr std::size_t kMaxPatterns = 1024;

  // Called at each change with the new refresh; 0: withdrawn.
  using Declare = std::function<void(const std::string& pattern, Duration refresh)>;
  explicit ClientInterests(Declare declare) : declare_(std::move(declare)) {}

  // Returns false if there are too many patterns.
  [[nodiscard]] bool add(const std::string& pattern, Duration refresh);
  // REQUIRES: add() succeeded with this refresh.
  void remove(const std::string& pattern, Duration refresh);

  [[nodiscard]] std::size_t count() const { return wished_.size(); }

 private:
  const Declare declare_;
  std::map<std::string, std::multiset<Duration>> wished_;
};

}  // namespace fieldcast::web
