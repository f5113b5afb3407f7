// Detects files that are not ours, such as a private key. They are never parsed, as faults would
// quote them to a user without permission to read them.
#pragma once

#include <initializer_list>
#include <string_view>

namespace fieldcast::config {

// Finds a key at the start of a line, or in a map in braces.
[[nodiscard]] bool has_top_key(std::string_view text, std::initializer_list<std::string_view> keys);

[[nodiscard]] bool has_columns(std::string_view text);

// Blank, or only comments.
[[nodiscard]] bool is_empty(std::string_view text);

[[nodiscard]] bool is_configuration(std::string_view text);
[[nodiscard]] bool is_template(std::string_view text);
[[nodiscard]] bool is_declaration(std::string_view text);

inline constexpr std::string_view kNoConfiguration = "this is no Fieldcast configuration";
inline constexpr std::string_view kNoTemplate = "this is no device template";
inline constexpr std::string_view kNoDeclaration = "this is no declaration of a protocol";
inline constexpr std::string_view kNoChannelList =
    "this is no channel list: its first row names the columns, in small letters, name and at among "
    "them (name,at,type)";

}  // namespace fieldcast::config
