#include "tools/cli/inspect.hpp"

#include <istream>
#include <ostream>

#include "core/base/bytes.hpp"
#include "core/protocol/protocol.hpp"
#include "tools/cli/inspect_view.hpp"
#include "tools/cli/json.hpp"
#include "tools/cli/suggestion.hpp"

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
  if (const auto near = nearest(name, names); !near.empty()) err << "; did you mean " << near << '?';
  err << "\nprotocols:\n";
  for (const auto& entry : protocols()) err << "  " << entry.name << "  " << entry.summary << '\n';
}

}  // namespace

ExitCode inspect(const InspectOptions& options, std::istream& in, std::ostream& out, std::ostream& err, const Screen& screen) {
  const auto* protocol = find_protocol(options.protocol);
  if (protocol == nullptr) {
    explain_unknown(options.protocol, err);
    return ExitCode::kUsage;
  }
  const auto hex = hex_of(options, in);
  const auto frame = hex.size() <= kMaxHexCharacters ? from_hex(hex) : std::nullopt;
  if (!frame || frame->empty()) {
    err << "fieldcast inspect: " << (hex.size() > kMaxHexCharacters ? "more than 65536 characters are" : "that is")
        << " no frame; write its bytes in hexadecimal, for instance 01 03 00 64 00 02 85 D4 or 01030064000285D4\n";
    return ExitCode::kUsage;
  }
  const auto fields = protocol->explain(*frame);
  if (options.json) {
    out << to_line(inspect_json(protocol->name, *frame, fields)) << '\n';
  } else {
    for (const auto& line : inspect_lines(protocol->name, *frame, fields, screen)) out << line << '\n';
  }
  return count_faults(fields) == 0 ? ExitCode::kOk : ExitCode::kFound;
}

}  // namespace fieldcast::cli
