// Whether the primary host application is online, from its STATE messages (Eclipse Sparkplug
// Specification 3.0.0, 5.4 and 6.4.29). Pure; one owner; of one connection.
#pragma once

#include <cstdint>
#include <optional>
#include <string_view>

namespace fieldcast::forward {

class PrimaryHost {
 public:
  // {"online":true,"timestamp":1764360000000}. A message that is older than the last one is
  // ignored: it is the will of an earlier session of the host. Returns false for any other text.
  bool on_state(std::string_view payload);
  [[nodiscard]] bool is_online() const { return is_online_; }

 private:
  std::optional<std::int64_t> timestamp_;
  bool is_online_ = false;
};

}  // namespace fieldcast::forward
