#include "tools/forward/settings/login_keys.hpp"

#include <fmt/format.h>

#include "config/document/limits.hpp"
#include "config/document/scalars.hpp"

namespace fieldcast::forward {

void read_files(config::MapReader& map, config::Library& library,
                std::initializer_list<std::pair<std::string_view, std::string*>> files) {
  for (const auto& [key, target] : files) {
    std::string path;
    if (map.read(key, path, config::TextRule{config::kMaxPath}))
      *target = library.check_file(*map.find(key));
  }
}

void check_pair(config::MapReader& map, std::string_view first, const std::string& first_value,
                std::string_view second, const std::string& second_value,
                std::string_view allowed) {
  if (first_value.empty() == second_value.empty()) return;
  const std::string_view there = first_value.empty() ? second : first;
  const std::string_view missing = first_value.empty() ? first : second;
  map.fault(there, fmt::format("'{}' without '{}'", there, missing), allowed);
}

}  // namespace fieldcast::forward
