// Loads a configuration: returns a BridgeSpec with all defaults, or the list of all faults.
// Stateless functions; any thread. They throw no exception, for any text. See config/limits.hpp for
// size limits.
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

using Loaded = tl::expected<BridgeSpec, std::vector<Fault>>;

// Faults are in the order of the text, those of the main file first; never empty on failure.
[[nodiscard]] Loaded load_file(const std::string& path,
                               const LoadOptions& options = default_options());

// `file_name` is shown in faults; relative names refer to its directory.
[[nodiscard]] Loaded load_text(std::string_view text, const std::string& file_name,
                               const FileReader& reader, const LoadOptions& options = {});

// Loaded from a file, or by the name of a declaration supplied with Fieldcast.
using LoadedDeclaration = tl::expected<declared::SharedDeclaration, std::vector<Fault>>;
[[nodiscard]] LoadedDeclaration load_declaration(const std::string& path_or_name,
                                                 const LoadOptions& options = default_options());
[[nodiscard]] LoadedDeclaration load_declaration_text(std::string_view text,
                                                      const std::string& file_name);

}  // namespace fieldcast::config
