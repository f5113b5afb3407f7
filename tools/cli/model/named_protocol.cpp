#include "tools/cli/model/named_protocol.hpp"

#include <filesystem>
#include <ostream>
#include <span>
#include <vector>

#include "config/loader/loader.hpp"
#include "core/base/message_text.hpp"
#include "core/protocol/families/registry.hpp"
#include "tools/cli/text/text_table.hpp"

namespace fieldcast::cli {
namespace {

void explain_unknown(const std::string& name, std::string_view command, std::ostream& err) {
  std::vector<std::string> names;
  for (const auto& entry : protocols()) names.emplace_back(entry.name);
  err << "fieldcast " << command << ": protocol '" << printable(name) << "' is unknown";
  if (const auto near = near_miss(name, names); !near.empty())
    err << "; did you mean " << near << '?';
  // Configurations find it by name in the directory next to them.
  const std::string own = "./protocols/" + name + ".yaml";
  std::error_code ignored;
  if (std::filesystem::exists(own, ignored)) err << "; a declaration is named by its file: " << own;
  err << "\nprotocols:\n";
  for (const auto& entry : protocols()) err << "  " << entry.name << "  " << entry.summary << '\n';
}

}  // namespace

std::optional<NamedProtocol> named_protocol(const std::string& name, std::string_view command,
                                            std::ostream& err) {
  if (const auto* entry = find_protocol(name)) return NamedProtocol{entry, {}};
  auto loaded = config::load_declaration(name);
  if (loaded) return NamedProtocol{nullptr, *std::move(loaded)};
  const bool is_path = name.find_first_of("/.") != std::string::npos;
  const auto& faults = loaded.error();
  const bool missing = faults.size() == 1 && faults.front().file == name;
  if (missing && !is_path)
    explain_unknown(name, command, err);
  else
    err << config::to_text(std::span(faults));
  return std::nullopt;
}

}  // namespace fieldcast::cli
