// Parses JSON, TOML and YAML to one tree with line numbers (config/document/document.hpp). Pure.
// Refuses more than kMaxTreeNodes nodes or kMaxTreeDepth levels.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <tl/expected.hpp>

#include "config/document/document.hpp"

namespace fieldcast::importing {

inline constexpr std::size_t kMaxTreeNodes = 2'000'000;
inline constexpr std::size_t kMaxTreeDepth = 64;

using config::Node;
using Tree = tl::expected<std::unique_ptr<config::Document>, std::string>;

// JSON with comments, as in wb-mqtt-serial. The error has the line.
[[nodiscard]] Tree read_json(std::string_view text);
[[nodiscard]] Tree read_toml(std::string_view text);
[[nodiscard]] Tree read_yaml_tree(std::string_view text);

// Null if the node is not a map or has no such key.
[[nodiscard]] const Node* child(const Node& map, std::string_view key);
[[nodiscard]] std::string_view text_of(const Node* node);
[[nodiscard]] std::string_view text_at(const Node& map, std::string_view key);
[[nodiscard]] std::optional<double> number_at(const Node& map, std::string_view key);
// Describes a value that is not a finite number.
[[nodiscard]] std::optional<std::string> fault_of_number(const Node& map, std::string_view key);
[[nodiscard]] std::optional<std::uint64_t> whole_at(const Node& map, std::string_view key);
// true, yes, on, 1; empty if the key is missing.
[[nodiscard]] std::optional<bool> bool_at(const Node& map, std::string_view key);
[[nodiscard]] bool is_list(const Node* node);
[[nodiscard]] bool is_map(const Node* node);
[[nodiscard]] inline unsigned line_of(const Node& node) { return node.position.line + 1; }

}  // namespace fieldcast::importing
