// The way from a configuration file to the model: a BridgeSpec with every default filled in, or the
// list of all faults at once.
//
// Functions without state; any thread. No exception leaves them, whatever the text holds. Sizes are
// bounded: see config/limits.hpp.
#pragma once

#include <functional>
#include <string>
#include <string_view>
#include <tl/expected.hpp>
#include <vector>

#include "config/fault.hpp"
#include "core/model/spec.hpp"

namespace fieldcast::config {

// What can go wrong with a file that a configuration names.
enum class FileError { kMissing, kUnreadable, kTooLarge };
[[nodiscard]] std::string_view to_text(FileError error);

// How the loader gets at channel lists and templates. Tests give it a map instead of a disk.
struct FileReader {
  // The whole content.
  std::function<tl::expected<std::string, FileError>(const std::string& path)> read;
  // Names of the files in a directory, for suggestions only; may be left empty.
  std::function<std::vector<std::string>(const std::string& directory)> list;
};

// Reads regular files of at most kMaxFileBytes.
[[nodiscard]] FileReader disk_reader();

struct LoadOptions {
  // Where `template: press` looks for press.yaml after the folder devices/ beside the
  // configuration.
  std::vector<std::string> template_directories;
  // Where `protocol: instrument` looks for instrument.yaml after the folder protocols/ beside it.
  std::vector<std::string> protocol_directories;
  // Whether a bus that could never carry its channels is a fault (core/schedule/overload.hpp).
  bool refuse_hopeless = true;
};

// The device templates and declared protocols that come with Fieldcast: those of the source tree or
// of the installation.
[[nodiscard]] LoadOptions default_options();

using Loaded = tl::expected<BridgeSpec, std::vector<Fault>>;

// Faults are in the order of the text, those of the main file first; never empty on failure.
[[nodiscard]] Loaded load_file(const std::string& path,
                               const LoadOptions& options = default_options());

// As load_file, with the text at hand. `file_name` stands in the faults, and its folder is where
// relative names begin.
[[nodiscard]] Loaded load_text(std::string_view text, const std::string& file_name,
                               const FileReader& reader, const LoadOptions& options = {});

// The declaration of a protocol by itself, from a file or from the name of one that comes with
// Fieldcast; its name is that of the file.
using LoadedDeclaration = tl::expected<declared::SharedDeclaration, std::vector<Fault>>;
[[nodiscard]] LoadedDeclaration load_declaration(const std::string& path_or_name,
                                                 const LoadOptions& options = default_options());
[[nodiscard]] LoadedDeclaration load_declaration_text(std::string_view text,
                                                      const std::string& file_name);

}  // namespace fieldcast::config
