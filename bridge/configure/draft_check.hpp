// Loads the text of a configuration with the bridge's loader, and predicts its buses. Reads the
// files that the text names. Any thread.
#pragma once

#include <cstdint>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "config/loader/loader.hpp"
#include "core/base/json.hpp"

namespace fieldcast::configure {

struct NamedFile {
  std::string name;  // path
  std::string text;
};

struct Draft {
  config::Loaded loaded = tl::unexpected(std::vector<config::Fault>{});
  config::Places places;         // of a valid text
  std::vector<NamedFile> files;  // channel lists, templates and protocols that were read
  std::set<std::string> paths;   // of all files that were read, also of keys and secrets
};

// The text that is in force.
[[nodiscard]] Draft load_present(std::string_view text, const std::string& file);

enum class Hopeless : std::uint8_t { kRefuse, kAccept };  // buses that cannot carry their channels
// Only files in the folder of `file`, in those of the library, and `also` are read: a draft must
// not open others of this machine.
[[nodiscard]] Draft load_draft(std::string_view text, const std::string& file,
                               const std::set<std::string>& also, Hopeless hopeless);

// [{"file", "line", "column", "message", "hint"}]
[[nodiscard]] Json faults_json(const std::vector<config::Fault>& faults);
// One fault at the begin of the file.
[[nodiscard]] Json fault_json(const std::string& file, const std::string& message,
                              const std::string& hint);

// [{"bus", "load", "feasible", "worst": [{"channel", "refresh_ms", "gap_ms"}], "infeasible":
// [channel], "remedies": [text]}]; seconds for thousands of channels.
[[nodiscard]] Json plans_json(const BridgeSpec& spec);

}  // namespace fieldcast::configure
