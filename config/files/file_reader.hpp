// Access to the files that a configuration names, and the search for templates and protocols.
#pragma once

#include <functional>
#include <initializer_list>
#include <string>
#include <string_view>
#include <tl/expected.hpp>
#include <vector>

#include "config/document/fault.hpp"

namespace fieldcast::config {

// Faults of a file that a configuration names.
enum class FileError { kMissing, kUnreadable, kTooLarge };
[[nodiscard]] std::string_view to_text(FileError error);

// Access to channel lists and templates; tests use a map instead of files.
struct FileReader {
  std::function<tl::expected<std::string, FileError>(const std::string& path)> read;
  // File names in a directory, only for suggestions; may be empty.
  std::function<std::vector<std::string>(const std::string& directory)> list;
};

[[nodiscard]] FileReader disk_reader();

struct LoadOptions {
  // Searched for press.yaml with `template: press`, after devices/ beside the configuration.
  std::vector<std::string> template_directories;
  // Searched for instrument.yaml with `protocol: instrument`, after protocols/ beside it.
  std::vector<std::string> protocol_directories;
  // A bus that cannot carry its channels is a fault (core/schedule/overload.hpp).
  bool refuse_hopeless = true;
  // Receives the positions of what was loaded; null: they are not kept.
  Places* places = nullptr;
};

// Those of the source tree or the installation.
[[nodiscard]] LoadOptions default_options();

// Detects files that are not ours, such as a private key. They are never parsed, as faults would
// quote them to a user without permission to read them.

// Finds a key at the start of a line, or in a map in braces.
[[nodiscard]] bool has_top_key(std::string_view text, std::initializer_list<std::string_view> keys);

[[nodiscard]] bool has_columns(std::string_view text);

// Blank, or only comments.
[[nodiscard]] bool is_empty(std::string_view text);

[[nodiscard]] bool is_configuration(std::string_view text);
[[nodiscard]] bool is_template(std::string_view text);
[[nodiscard]] bool is_declaration(std::string_view text);

inline constexpr std::string_view kNoConfiguration = "this is no Fieldcast configuration";
inline constexpr std::string_view kNoTemplate =
    "this is no device template, which has channels or protocols";
inline constexpr std::string_view kNoDeclaration = "this is no declaration of a protocol";
inline constexpr std::string_view kNoChannelList =
    "this is no channel list: its first row names the columns, in small letters, name and at among "
    "them (name,at,type)";

}  // namespace fieldcast::config
