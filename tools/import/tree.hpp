// JSON, TOML and YAML as one tree of nodes that know their line (config/document.hpp), and short
// ways to look into it. Pure.
//
// Bounds: kMaxTreeNodes nodes, kMaxTreeDepth levels; beyond them a text is refused.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <tl/expected.hpp>

#include "config/document.hpp"

namespace fieldcast::importing {

inline constexpr std::size_t kMaxTreeNodes = 2'000'000;
inline constexpr std::size_t kMaxTreeDepth = 64;

using config::Node;
using Tree = tl::expected<std::unique_ptr<config::Document>, std::string>;

// JSON; comments are fine, as wb-mqtt-serial has them. The error names the line.
[[nodiscard]] Tree read_json(std::string_view text);
[[nodiscard]] Tree read_toml(std::string_view text);
[[nodiscard]] Tree read_yaml_tree(std::string_view text);

// The value of a key; nothing if the node is no map or has no such key.
[[nodiscard]] const Node* child(const Node& map, std::string_view key);
// Of a scalar; empty for anything else.
[[nodiscard]] std::string_view text_of(const Node* node);
[[nodiscard]] std::string_view text_at(const Node& map, std::string_view key);
[[nodiscard]] std::optional<double> number_at(const Node& map, std::string_view key);
// Of a key that is there and whose value is no number, or one without an end: a few words.
[[nodiscard]] std::optional<std::string> fault_of_number(const Node& map, std::string_view key);
[[nodiscard]] std::optional<std::uint64_t> whole_at(const Node& map, std::string_view key);
// true, yes, on, 1; nothing if the key is not there.
[[nodiscard]] std::optional<bool> bool_at(const Node& map, std::string_view key);
[[nodiscard]] bool is_list(const Node* node);
[[nodiscard]] bool is_map(const Node* node);
[[nodiscard]] inline unsigned line_of(const Node& node) { return node.position.line + 1; }

}  // namespace fieldcast::importing
