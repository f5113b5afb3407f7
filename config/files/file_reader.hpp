// Access to the files that a configuration names, and where the loader looks for templates and
// declared protocols.
#pragma once

#include <functional>
#include <string>
#include <string_view>
#include <tl/expected.hpp>
#include <vector>

#include "config/document/places.hpp"

namespace fieldcast::config {

// What can go wrong with a file that a configuration names.
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

}  // namespace fieldcast::config
