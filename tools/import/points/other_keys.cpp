#include "tools/import/points/other_keys.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace fieldcast::importing {
namespace {

constexpr std::size_t kMaxOthers = 50;

}  // namespace

void OtherKeys::look(const Node& map, std::string_view of,
                     std::initializer_list<std::string_view> known) {
  for (const Node::Entry& entry : map.entries) {
    const Node& key = *entry.key;
    if (std::ranges::find(known, key.text) == known.end()) add(key.text, of, line_of(key));
  }
}

void OtherKeys::add(std::string_view key, std::string_view of, unsigned line) {
  const auto other = std::ranges::find_if(
      others_, [&](const Other& one) { return one.key == key && one.of == of; });
  if (other != others_.end()) {
    ++other->count;
  } else if (others_.size() < kMaxOthers) {
    others_.push_back({key, of, line, 1});
  }
}

void OtherKeys::tell(const std::string& file, Found& found) const {
  for (const Other& other : others_) {
    std::string note = fmt::format("{}: key '{}' of {} (line {}{}) is not moved", file, other.key,
                                   other.of, other.line, other.count > 1 ? ", .." : "");
    // Several devices may use the same template.
    if (std::ranges::find(found.notes, note) == found.notes.end())
      found.notes.push_back(std::move(note));
  }
}

}  // namespace fieldcast::importing
