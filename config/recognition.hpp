// Whether a text is one of our files at all. One that is not, /etc/shadow or a private key, is
// never parsed: what is wrong with it would quote it to somebody who may not read it.
#pragma once

#include <initializer_list>
#include <string_view>

namespace fieldcast::config {

// The outermost map has one of these keys, as far as that can be seen without parsing: at the
// beginning of a line, or in a map in braces.
[[nodiscard]] bool has_top_key(std::string_view text, std::initializer_list<std::string_view> keys);

// The first line of a channel list names columns of ours.
[[nodiscard]] bool has_columns(std::string_view text);

// No text stands in it, or comments alone.
[[nodiscard]] bool is_empty(std::string_view text);

// A file that may be meant for the bridge.
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
