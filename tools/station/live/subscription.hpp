// The patterns of a client. A pure value.
#pragma once

#include <cstddef>
#include <map>
#include <string>

#include "core/model/channel_pattern.hpp"
#include "tools/station/model/live_model.hpp"

namespace fieldcast::web {

class LiveSubscription {
 public:
  static constexpr std::size_t kMaxPatterns = 16;

  // Returns true if further channels may match now. REQUIRES: has_room().
  bool add(const Pattern& pattern);
  bool remove(const Pattern& pattern);
  [[nodiscard]] bool has(const Pattern& pattern) const {
    return patterns_.contains(pattern.text());
  }
  [[nodiscard]] bool has_room() const { return patterns_.size() < kMaxPatterns; }
  [[nodiscard]] bool empty() const { return patterns_.empty(); }

  [[nodiscard]] bool matches(const StationChannel& channel) const;
  // Equal for clients with the same patterns.
  [[nodiscard]] const std::string& key() const { return key_; }

 private:
  static constexpr const char* kEverything = "*/*/*";
  void make_key();

  std::map<std::string, Pattern> patterns_;
  std::string key_;
};

}  // namespace fieldcast::web
