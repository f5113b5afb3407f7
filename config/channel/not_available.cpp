#include "config/channel/not_available.hpp"

#include <fmt/format.h>

#include "config/document/limits.hpp"
#include "config/document/scalars.hpp"

namespace fieldcast::config {
namespace {

constexpr std::string_view kKey = "not-available";

std::string values_allowed(const Encoding& encoding) {
  const Encoding plain{.type = encoding.type};
  const std::string bits = fmt::format("0x0 to 0x{:X} (the bits of {})",
                                       UINT64_MAX >> (64 - width_bits(plain)), to_text(plain));
  const bool real = encoding.type == ValueType::kFloat32 || encoding.type == ValueType::kFloat64;
  return bits + (real ? ", a number, or nan" : ", or a raw number of the type");
}

// A cell of a channel list may contain several, separated by spaces.
void add_values(const Node& node, Encoding& encoding, FaultList& faults) {
  const std::string allowed = values_allowed(encoding);
  const std::string* text = scalar_of(node, kKey, allowed, faults);
  if (text == nullptr) return;
  std::string_view rest = *text;
  do {
    const auto end = std::min(rest.find(' '), rest.size());
    const std::string_view word = rest.substr(0, end);
    rest.remove_prefix(std::min(rest.find_first_not_of(' ', end), rest.size()));
    const auto bits = parse_not_available(encoding, word);
    if (!bits) {
      faults.add(node.position,
                 fmt::format("{} '{}' is not a raw value of type {}", kKey, word,
                             to_text(Encoding{.type = encoding.type})),
                 allowed);
      return;
    }
    encoding.not_available.push_back(*bits);
  } while (!rest.empty());
}

}  // namespace

void read_not_available(MapReader& map, bool typed, Encoding& encoding) {
  const Node* node = map.find(kKey);
  if (node == nullptr || !typed) return;
  if (encoding.type == ValueType::kBool || encoding.type == ValueType::kString) {
    map.faults().add(node->position, fmt::format("'{}' at a {}", kKey, to_text(encoding.type)),
                     "a channel of a numeric type");
    return;
  }
  if (node->kind == Kind::kList) {
    for (const Node* item : node->items) add_values(*item, encoding, map.faults());
  } else {
    add_values(*node, encoding, map.faults());
  }
  if (encoding.not_available.size() > kMaxNotAvailable ||
      (node->kind == Kind::kList && node->items.empty())) {
    map.faults().add(node->position,
                     fmt::format("{} has {} values", kKey, encoding.not_available.size()),
                     fmt::format("1 to {} values", kMaxNotAvailable));
  }
}

std::string not_available_schema() {
  const std::string value = R"({ "type": ["string", "number"] })";
  return fmt::format(R"({{ "anyOf": [ {0}, )"
                     R"({{ "type": "array", "minItems": 1, "maxItems": {1}, "items": {0} }} ] }})",
                     value, kMaxNotAvailable);
}

}  // namespace fieldcast::config
