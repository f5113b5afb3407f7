// JSON of a view as a tree, read by a library of others.
#pragma once

#include <nlohmann/json.hpp>

#include "core/base/json.hpp"

namespace fieldcast::cli {

inline nlohmann::ordered_json parsed(const std::string& text) {
  return nlohmann::ordered_json::parse(text);
}
inline nlohmann::ordered_json parsed(const Json& json) { return parsed(json.text()); }

}  // namespace fieldcast::cli
