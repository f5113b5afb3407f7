#include "tools/cli/view/json.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <variant>

#include "core/base/escaped.hpp"
#include "core/base/printable.hpp"

namespace fieldcast::cli {
namespace {

// All characters that are not is_printable() are at most U+FFFF, and occur only in strings, where
// the writer has already escaped ASCII.
std::string without_unprintable(std::string_view json) {
  std::string out;
  out.reserve(json.size());
  while (!json.empty()) {
    const std::string_view character = json.substr(0, std::max<std::size_t>(1, utf8_length(json)));
    if (is_printable(character)) {
      out += character;
    } else {
      auto code = static_cast<unsigned>(static_cast<unsigned char>(character[0]));
      if (character.size() > 1) code &= 0xFFu >> (character.size() + 1);
      for (const char c : character.substr(1))
        code = code << 6 | (static_cast<unsigned char>(c) & 0x3Fu);
      out += fmt::format("\\u{:04x}", code);
    }
    json.remove_prefix(character.size());
  }
  return out;
}

}  // namespace

Json to_json(const Value& value) {
  if (const auto* text = std::get_if<std::string>(&value); text != nullptr && !is_utf8(*text))
    return escaped(*text);
  return std::visit([](const auto& plain) { return Json(plain); },
                    value);  // NaN and infinities become null when written
}

std::string to_line(const Json& json) {
  return without_unprintable(json.dump(-1, ' ', false, Json::error_handler_t::replace));
}

}  // namespace fieldcast::cli
