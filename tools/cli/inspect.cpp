#include "tools/cli/inspect.hpp"

#include <istream>
#include <optional>
#include <ostream>
#include <span>

#include "config/loader.hpp"
#include "core/base/bytes.hpp"
#include "core/base/near_miss.hpp"
#include "core/protocol/protocol.hpp"
#include "tools/cli/inspect_view.hpp"
#include "tools/cli/json.hpp"

namespace fieldcast::cli {
namespace {

constexpr std::size_t kMaxHexCharacters = 65536;  // of the whole input; a frame is far shorter, a slip of the hand far longer

std::string hex_of(const InspectOptions& options, std::istream& in) {
  std::string hex;
  for (const auto& part : options.hex) hex += part + ' ';
  if (options.hex.empty()) {
    for (char c; hex.size() <= kMaxHexCharacters && in.get(c);) hex += c;
  }
  return hex;
}

void explain_unknown(const std::string& name, std::ostream& err) {
  std::vector<std::string> names;
  for (const auto& entry : protocols()) names.emplace_back(entry.name);
  err << "fieldcast inspect: protocol '" << printable(name) << "' is unknown";
  if (const auto near = near_miss(name, names); !near.empty()) err << "; did you mean " << near << '?';
  err << "\nprotocols:\n";
  for (const auto& entry : protocols()) err << "  " << entry.name << "  " << entry.summary << '\n';
}

// A declaration by its path, or by the name of one that comes with Fieldcast; what is wrong with it goes to err.
std::optional<declared::SharedDeclaration> declared_protocol(const std::string& name, std::ostream& err) {
  auto loaded = config::load_declaration(name);
  if (loaded) return *loaded;
  const bool is_path = name.find_first_of("/.") != std::string::npos;
  const auto& faults = loaded.error();
  const bool missing = faults.size() == 1 && faults.front().file == name;
  if (missing && !is_path)
    explain_unknown(name, err);
  else
    err << config::to_text(std::span(faults));
  return std::nullopt;
}

}  // namespace

ExitCode inspect(const InspectOptions& options, std::istream& in, std::ostream& out, std::ostream& err, const Screen& screen) {
  const auto* built_in = find_protocol(options.protocol);
  declared::SharedDeclaration declaration;
  if (built_in == nullptr) {
    auto loaded = declared_protocol(options.protocol, err);
    if (!loaded) return ExitCode::kUsage;
    declaration = std::move(*loaded);
  }
  const auto hex = hex_of(options, in);
  const auto frame = hex.size() <= kMaxHexCharacters ? from_hex(hex) : std::nullopt;
  if (!frame || frame->empty()) {
    err << "fieldcast inspect: " << (hex.size() > kMaxHexCharacters ? "more than 65536 characters are" : "that is")
        << " no frame; write its bytes in hexadecimal, for instance 01 03 00 64 00 02 85 D4 or 01030064000285D4\n";
    return ExitCode::kUsage;
  }
  const auto fields = built_in != nullptr ? built_in->explain(*frame) : declared::explain(*declaration.value, *frame);
  const std::string_view name = built_in != nullptr ? built_in->name : std::string_view(declaration.value->name);
  if (options.json) {
    out << to_line(inspect_json(name, *frame, fields)) << '\n';
  } else {
    for (const auto& line : inspect_lines(name, *frame, fields, screen)) out << line << '\n';
  }
  return count_faults(fields) == 0 ? ExitCode::kOk : ExitCode::kFound;
}

}  // namespace fieldcast::cli
