#include "tools/cli/json.hpp"

#include <variant>

namespace fieldcast::cli {

Json to_json(const Value& value) {
  return std::visit([](const auto& plain) { return Json(plain); }, value);  // NaN and infinities become null when written
}

std::string to_line(const Json& json) { return json.dump(-1, ' ', false, Json::error_handler_t::replace); }

}  // namespace fieldcast::cli
