// Loads a configuration: a BridgeSpec with all defaults, or the list of all faults. Stateless,
// without exceptions; any thread. config/document/limits.hpp has the size limits.
#pragma once

#include <string>
#include <string_view>
#include <tl/expected.hpp>
#include <vector>

#include "config/document/fault.hpp"
#include "config/files/file_reader.hpp"
#include "core/model/spec.hpp"

namespace fieldcast::config {

struct Document;

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
