// The keys of a field that only some kinds of fields have.
#include <fmt/format.h>

#include <algorithm>

#include "config/declaration/declared_frame.hpp"
#include "config/document/suggest.hpp"

namespace fieldcast::config {
namespace {

using declared::FieldKind;

// In addition to name, is, constant and the widths.
struct Meaning {
  std::string_view key;
  std::initializer_list<FieldKind> kinds;
};
const Meaning kMeanings[] = {
    {"plus",
     {FieldKind::kAddress, FieldKind::kCommand, FieldKind::kFirst, FieldKind::kCount,
      FieldKind::kLast, FieldKind::kLength, FieldKind::kExponent, FieldKind::kDecimals}},
    {"times", {FieldKind::kFirst, FieldKind::kCount, FieldKind::kLast}},
    {"of",
     {FieldKind::kLength, FieldKind::kChecksum, FieldKind::kExponent, FieldKind::kDecimals,
      FieldKind::kSign}},
    {"kind", {FieldKind::kChecksum}},
    {"complement", {FieldKind::kChecksum}},
    {"start", {FieldKind::kChecksum}},
    {"over", {FieldKind::kChecksum}},
    {"on", {FieldKind::kItems, FieldKind::kSign}},
    {"off", {FieldKind::kItems, FieldKind::kSign}},
    {"ok", {FieldKind::kError}},
    {"text", {FieldKind::kValue, FieldKind::kAddress, FieldKind::kUnused}},
    {"variable",
     {FieldKind::kValue, FieldKind::kUnused, FieldKind::kAddress, FieldKind::kFirst,
      FieldKind::kCount, FieldKind::kLast, FieldKind::kItems}},
    {"separator", {FieldKind::kItems}},
    {"optional", {FieldKind::kConstant}},
    {"signed", {FieldKind::kValue, FieldKind::kItems, FieldKind::kExponent, FieldKind::kDecimals}},
    {"fill", {FieldKind::kUnused, FieldKind::kRate}},
    {"rates", {FieldKind::kRate}},
    {"key", {FieldKind::kValue, FieldKind::kUnused}},
    {"after", {FieldKind::kValue}},
    {"until", {FieldKind::kValue}},
    {"counts", {FieldKind::kLength}},
};

}  // namespace

void refuse_meaningless(MapReader& field, FieldKind kind) {
  for (const auto& [key, kinds] : kMeanings) {
    if (!field.has(key) || std::ranges::find(kinds, kind) != kinds.end()) continue;
    std::vector<std::string_view> words;
    for (const FieldKind each : kinds) words.push_back(declared::to_text(each));
    field.fault(
        key,
        fmt::format("'{}' has no meaning for a field that is {}", key, declared::to_text(kind)),
        "it belongs to " + joined(words));
  }
}

}  // namespace fieldcast::config
