#include "tools/cli/view/json.hpp"

#include <variant>

#include "core/base/escaped.hpp"

namespace fieldcast::cli {

Json to_json(const Value& value) {
  if (const auto* text = std::get_if<std::string>(&value); text != nullptr && !is_utf8(*text))
    return escaped(*text);
  return std::visit([](const auto& plain) { return Json(plain); },
                    value);  // NaN and infinities become null when written
}

std::string to_line(const Json& json) {
  return json.dump(-1, ' ', false, Json::error_handler_t::replace);
}

}  // namespace fieldcast::cli
