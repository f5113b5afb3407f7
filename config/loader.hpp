// The way from a configuration file to the model: a BridgeSpec with every default filled in, or the
// list of all faults at once.
//
// Functions without state; any thread. No exception leaves them, whatever the text holds. Sizes are
// bounded: see config/limits.hpp.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <tl/expected.hpp>
#include <utility>
#include <vector>

#include "config/fault.hpp"
#include "core/model/spec.hpp"

namespace fieldcast::config {

struct Document;

// The positions of the keys of a configuration, for faults that only the machine shows: a folder
// that is missing, a certificate that has expired. Keeps the text of the main file. Copies share
// it; any thread.
class Places {
 public:
  Places() = default;
  explicit Places(std::shared_ptr<const Document> document) : document_(std::move(document)) {}

  // "plant.yaml:7:5": the position of the value at a path of keys, with numbers for the items of a
  // list: "buses.0.capture.folder". An absent key has the position of the map that it belongs to.
  // Empty if no file was loaded.
  [[nodiscard]] std::string at(std::string_view path) const;

 private:
  std::shared_ptr<const Document> document_;
};

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
  // Receives the positions of what was loaded; null: they are not kept.
  Places* places = nullptr;
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
