// Rules for values of keys: rule(node, key, faults) returns the value, or adds a fault and returns
// empty. schema() is its JSON Schema, form() a human-readable form or empty.
#pragma once

#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "config/document/document.hpp"
#include "config/document/suggest.hpp"
#include "core/base/time.hpp"

namespace fieldcast::config {

// The text of a scalar node; otherwise null with a fault. `wanted`: "a duration".
[[nodiscard]] const std::string* scalar_of(const Node& node, std::string_view key,
                                           std::string_view wanted, FaultList& faults);

// Returns true for a list of `least` to `most` items; otherwise false with a fault: "key is empty".
[[nodiscard]] bool is_list(const Node& node, std::string_view key, std::size_t least,
                           std::size_t most, std::string_view allowed, FaultList& faults,
                           std::string_view suggestion = {});
inline constexpr std::size_t kAnyCount = SIZE_MAX;

// "[a]", the list that a single value probably means; empty for other nodes.
[[nodiscard]] std::string as_list(const Node& node);

// "2", "-0.5", "1e3"; finite.
[[nodiscard]] std::optional<double> number_from(std::string_view text);
// "12", "-3", "0x1F".
[[nodiscard]] std::optional<std::int64_t> whole_from(std::string_view text);

// "192.168.1.7".
[[nodiscard]] bool is_ipv4(std::string_view text);

struct DurationRule {  // see core/base/duration_text.hpp
  Duration min, max;
  std::string_view or_else = {};  // a word that the caller also accepts: ", or forever"
  std::optional<Duration> operator()(const Node& node, std::string_view key,
                                     FaultList& faults) const;
  [[nodiscard]] std::string schema() const;
  [[nodiscard]] std::string form() const;
};

struct WholeRule {
  std::int64_t min, max;
  std::optional<std::int64_t> operator()(const Node& node, std::string_view key,
                                         FaultList& faults) const;
  [[nodiscard]] std::string schema() const;
  [[nodiscard]] std::string form() const;
};

struct NumberRule {
  double min = std::numeric_limits<double>::lowest(), max = std::numeric_limits<double>::max();
  std::optional<double> operator()(const Node& node, std::string_view key, FaultList& faults) const;
  [[nodiscard]] std::string schema() const;
  [[nodiscard]] std::string form() const;
};

// A size or rate with a unit: "500kB/s", "10MB".
struct SizeRule {
  std::int64_t min, max;
  std::string_view range, allowed;  // "10MB to 1000TB", "10MB to 1000TB, with MB, GB or TB"
  std::string_view pattern;         // of the schema, without ^ and $
  std::span<const std::pair<std::string_view, std::int64_t>> units;  // with their worth
  bool fractions = false;
  std::string_view outside = "is out of range";
  std::optional<std::int64_t> operator()(const Node& node, std::string_view key,
                                         FaultList& faults) const;
  [[nodiscard]] std::string schema() const;
  [[nodiscard]] std::string form() const { return std::string(range); }
};

struct FlagRule {  // true, false
  std::optional<bool> operator()(const Node& node, std::string_view key, FaultList& faults) const;
  [[nodiscard]] std::string schema() const;
  [[nodiscard]] std::string form() const;
};

struct TextRule {  // one line without control characters
  std::size_t max_bytes;
  std::optional<std::string> operator()(const Node& node, std::string_view key,
                                        FaultList& faults) const;
  [[nodiscard]] std::string schema() const;
  [[nodiscard]] std::string form() const;
};

// 1..64 of letters, digits, '-', '_', '.', as names become parts of paths and patterns.
struct NameRule {
  std::optional<std::string> operator()(const Node& node, std::string_view key,
                                        FaultList& faults) const;
  [[nodiscard]] std::string schema() const;
  [[nodiscard]] std::string form() const;
};

// { "enum": ["a", true, 1] } and "`a`, `true`, `1`".
[[nodiscard]] std::string schema_of_words(std::span<const std::string_view> words);
[[nodiscard]] std::string form_of_words(std::span<const std::string_view> words);

template <typename T>
struct ChoiceRule {
  std::span<const std::pair<std::string_view, T>> choices;

  std::optional<T> operator()(const Node& node, std::string_view key, FaultList& faults) const {
    const std::string* text = scalar_of(node, key, "one of " + joined(words()), faults);
    if (text == nullptr) return std::nullopt;
    for (const auto& [word, value] : choices) {
      if (*text == word) return value;
    }
    const auto meant = meant_value(key, *text);
    faults.add(node.position, std::string(key) + " '" + *text + "' is unknown", joined(words()),
               meant.empty() ? closest(*text, words()) : meant);
    return std::nullopt;
  }
  [[nodiscard]] std::string schema() const { return schema_of_words(words()); }
  [[nodiscard]] std::string form() const { return form_of_words(words()); }

 private:
  [[nodiscard]] std::vector<std::string_view> words() const {
    std::vector<std::string_view> all;
    for (const auto& [word, value] : choices) all.push_back(word);
    return all;
  }
};

}  // namespace fieldcast::config
