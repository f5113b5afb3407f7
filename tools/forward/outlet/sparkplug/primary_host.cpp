#include "tools/forward/outlet/sparkplug/primary_host.hpp"

#include <nlohmann/json.hpp>

namespace fieldcast::forward {

bool PrimaryHost::on_state(std::string_view payload) {
  const auto json = nlohmann::json::parse(payload, nullptr, false);
  if (!json.is_object()) return false;
  const auto online = json.find("online"), timestamp = json.find("timestamp");
  if (online == json.end() || !online->is_boolean() || timestamp == json.end() ||
      !timestamp->is_number_integer())
    return false;
  const auto at = timestamp->get<std::int64_t>();
  if (timestamp_ && at < *timestamp_) return true;
  timestamp_ = at;
  is_online_ = online->get<bool>();
  return true;
}

}  // namespace fieldcast::forward
