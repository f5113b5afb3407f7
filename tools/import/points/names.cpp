#include "tools/import/points/names.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <optional>

namespace fieldcast::importing {

namespace {

constexpr std::size_t kMaxName = 64;

// U+00C0 to U+00FF without accents.
constexpr std::array<std::string_view, 64> kLatin{
    "A", "A", "A", "A", "Ae", "A", "AE", "C", "E", "E", "E", "E", "I",  "I", "I",  "I",
    "D", "N", "O", "O", "O",  "O", "Oe", "x", "O", "U", "U", "U", "Ue", "Y", "Th", "ss",
    "a", "a", "a", "a", "ae", "a", "ae", "c", "e", "e", "e", "e", "i",  "i", "i",  "i",
    "d", "n", "o", "o", "o",  "o", "oe", "-", "o", "u", "u", "u", "ue", "y", "th", "y"};

bool plain(char c) {
  return (c >= '0' && c <= '9') || (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '-' ||
         c == '_' || c == '.';
}

std::optional<std::string_view> without_accent(std::string_view two) {
  if (two.size() < 2 || two[0] != '\xC3') return std::nullopt;
  const auto second = static_cast<unsigned char>(two[1]);
  if (second < 0x80 || second > 0xBF) return std::nullopt;
  return kLatin[second - 0x80];
}

}  // namespace

std::string plain_name(std::string_view name) {
  std::string result;
  for (std::size_t i = 0; i < name.size(); ++i) {
    if (plain(name[i])) {
      result += name[i];
    } else if (const auto letters = without_accent(name.substr(i, 2))) {
      result += *letters;
      ++i;
    } else if (name[i] == '%') {
      result += "pct";
    } else if (!result.empty() && result.back() != '-') {
      result += '-';
    }
  }
  if (result.size() > kMaxName) result.resize(kMaxName);
  while (result.ends_with('-')) result.pop_back();
  while (result.starts_with('-')) result.erase(0, 1);
  return result;
}

std::string cut_text(std::string_view utf8, std::size_t bytes) {
  if (utf8.size() <= bytes) return std::string(utf8);
  while (bytes > 0 && (static_cast<unsigned char>(utf8[bytes]) & 0xC0) == 0x80) --bytes;
  return std::string(utf8.substr(0, bytes));
}

std::string UniqueNames::unique(std::string name) {
  for (;;) {
    const unsigned times = ++given_[name];
    if (times == 1) return name;
    const std::string number = "-" + std::to_string(times);
    std::string other = name.substr(0, kMaxName - number.size()) + number;
    if (!given_.contains(other)) {
      given_[other] = 1;
      return other;
    }
  }
}

namespace {

constexpr std::size_t kMaxOthers = 50;

}  // namespace

void OtherKeys::look(const Node& map, std::string_view of, std::string_view known) {
  for (const Node::Entry& entry : map.entries) {
    const Node& key = *entry.key;
    if (!is_one_of(key.text, known)) add(key.text, of, line_of(key));
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
