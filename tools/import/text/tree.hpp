// Parses JSON, TOML and YAML to one tree with line numbers (config/document/document.hpp). Pure.
// Refuses more than kMaxTreeNodes nodes or kMaxTreeDepth levels.
#pragma once

#include <initializer_list>
#include <memory>
#include <optional>
#include <string_view>

#include "config/document/document.hpp"
#include "tools/import/text/text.hpp"

namespace fieldcast::importing {

inline constexpr std::size_t kMaxTreeNodes = 2'000'000;
inline constexpr std::size_t kMaxTreeDepth = 64;

using config::Node;
using Tree = Result<std::unique_ptr<config::Document>>;

// JSON with comments, as in wb-mqtt-serial. The error has the line.
[[nodiscard]] Tree read_json(std::string_view text);
[[nodiscard]] Tree read_toml(std::string_view text);
[[nodiscard]] Tree read_yaml_tree(std::string_view text);

[[nodiscard]] const Node* child(const Node& map, std::string_view key);
[[nodiscard]] std::string_view text_of(const Node* node);
[[nodiscard]] std::string_view text_at(const Node& map, std::string_view key);
[[nodiscard]] std::string_view first_text(const Node& map,
                                          std::initializer_list<std::string_view> keys);
[[nodiscard]] std::optional<double> number_at(const Node& map, std::string_view key);
[[nodiscard]] MayFail fault_of_number(const Node& map, std::string_view key);
// Reads a scale. Without the key, or for 0, the scale stays.
[[nodiscard]] MayFail read_scale_at(const Node& map, std::string_view key, double& scale);
[[nodiscard]] std::optional<std::uint64_t> whole_at(const Node& map, std::string_view key);
template <typename T = unsigned>
[[nodiscard]] std::optional<T> small_at(const Node& map, std::string_view key, std::uint64_t least,
                                        std::uint64_t most) {
  return whole_from<T>(text_at(map, key), least, most);
}
// true, yes, on, 1; empty if the key is missing.
[[nodiscard]] std::optional<bool> bool_at(const Node& map, std::string_view key);
[[nodiscard]] bool is_list(const Node* node);
[[nodiscard]] bool is_map(const Node* node);
[[nodiscard]] const config::LeanList<const Node*>& items_of(const Node* node);
[[nodiscard]] inline unsigned line_of(const Node& node) { return node.position.line + 1; }

}  // namespace fieldcast::importing
