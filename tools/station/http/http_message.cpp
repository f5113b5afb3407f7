#include "tools/station/http/http_message.hpp"

#include <algorithm>
#include <array>

#include "core/base/json.hpp"

namespace fieldcast::web {
namespace {

constexpr std::size_t kMaxParameters = 64;

constexpr std::array kMethods{std::pair{Method::kGet, std::string_view("GET")},
                              std::pair{Method::kPost, std::string_view("POST")},
                              std::pair{Method::kDelete, std::string_view("DELETE")}};

std::optional<unsigned> hex_digit(char c) {
  if (c >= '0' && c <= '9') return c - '0';
  if (c >= 'a' && c <= 'f') return c - 'a' + 10;
  if (c >= 'A' && c <= 'F') return c - 'A' + 10;
  return std::nullopt;
}

// Percent escapes (RFC 3986, 2.1); in a query "+" is a space. Empty if invalid or a zero byte.
std::optional<std::string> decoded(std::string_view text, bool in_query) {
  std::string out;
  out.reserve(text.size());
  for (std::size_t i = 0; i < text.size(); ++i) {
    char c = text[i];
    if (c == '+' && in_query) c = ' ';
    if (c == '%') {
      if (text.size() - i < 3) return std::nullopt;
      const auto high = hex_digit(text[i + 1]);
      const auto low = hex_digit(text[i + 2]);
      if (!high || !low) return std::nullopt;
      c = static_cast<char>(*high * 16 + *low);
      i += 2;
    }
    if (c == '\0') return std::nullopt;
    out += c;
  }
  return out;
}

}  // namespace

std::string_view to_text(Method method) {
  return std::ranges::find(kMethods, method, &decltype(kMethods)::value_type::first)->second;
}

std::optional<Method> method_from(std::string_view text) {
  const auto found = std::ranges::find(kMethods, text, &decltype(kMethods)::value_type::second);
  if (found == kMethods.end()) return std::nullopt;
  return found->first;
}

std::optional<std::string> HttpRequest::parameter(std::string_view name) const {
  const auto found = std::ranges::find(query, name, &TextPairs::value_type::first);
  if (found == query.end()) return std::nullopt;
  return found->second;
}

std::vector<std::string> HttpRequest::parameters(std::string_view name) const {
  std::vector<std::string> values;
  for (const auto& [key, value] : query) {
    if (key == name) values.push_back(value);
  }
  return values;
}

HttpResponse error_response(unsigned status, std::string_view error, std::string_view hint) {
  HttpResponse response;
  response.status = status;
  response.body = JsonObject().add("error", error).add("hint", hint).take();
  return response;
}

std::optional<Target> parse_target(std::string_view text) {
  if (!text.starts_with('/')) return std::nullopt;
  const std::size_t mark = text.find('?');
  auto path = decoded(text.substr(0, mark), false);
  if (!path) return std::nullopt;
  Target target{std::move(*path), {}};
  std::string_view rest = mark == text.npos ? std::string_view() : text.substr(mark + 1);
  while (!rest.empty()) {
    const std::string_view one = rest.substr(0, rest.find('&'));
    rest.remove_prefix(std::min(rest.size(), one.size() + 1));
    if (one.empty()) continue;
    const std::size_t equals = std::min(one.find('='), one.size());
    auto key = decoded(one.substr(0, equals), true);
    auto value = decoded(one.substr(std::min(one.size(), equals + 1)), true);
    if (!key || !value || target.query.size() == kMaxParameters) return std::nullopt;
    target.query.emplace_back(std::move(*key), std::move(*value));
  }
  return target;
}

}  // namespace fieldcast::web
