#include "tools/cli/command/inspect.hpp"

#include <istream>
#include <ostream>

#include "core/base/bytes.hpp"
#include "tools/cli/command/command.hpp"
#include "tools/cli/model/named_protocol.hpp"
#include "tools/cli/view/inspect_view.hpp"
#include "tools/cli/view/json.hpp"

namespace fieldcast::cli {
namespace {

// Of the whole input; a frame is far shorter, a slip of the hand far longer.
constexpr std::size_t kMaxHexCharacters = 65536;

std::string hex_of(const InspectOptions& options, std::istream& in) {
  std::string hex;
  for (const auto& part : options.hex) hex += part + ' ';
  if (options.hex.empty()) {
    for (char c; hex.size() <= kMaxHexCharacters && in.get(c);) hex += c;
  }
  return hex;
}

}  // namespace

ExitCode inspect(const InspectOptions& options, std::istream& in, std::ostream& out,
                 std::ostream& err, const Screen& screen) {
  const auto protocol = named_protocol(options.protocol, "inspect", err);
  if (!protocol) return ExitCode::kUsage;
  const auto hex = hex_of(options, in);
  const auto frame = hex.size() <= kMaxHexCharacters ? from_hex(hex) : std::nullopt;
  if (!frame || frame->empty()) {
    err << "fieldcast inspect: "
        << (hex.size() > kMaxHexCharacters ? "more than 65536 characters are" : "that is")
        << " no frame; write its bytes in hexadecimal, for instance 01 03 00 64 00 02 85 D4 or "
           "01030064000285D4\n";
    return ExitCode::kUsage;
  }
  const auto fields = protocol->built_in != nullptr
                          ? protocol->built_in->explain(*frame)
                          : declared::explain(*protocol->declaration.value, *frame);
  const std::string_view name = protocol->name();
  if (options.json) {
    out << to_line(inspect_json(name, *frame, fields)) << '\n';
  } else {
    for (const auto& line : inspect_lines(name, *frame, fields, screen)) out << line << '\n';
  }
  return count_faults(fields) == 0 ? ExitCode::kOk : ExitCode::kFound;
}

namespace {

class InspectCommand final : public CommandWith<InspectOptions> {
 public:
  void describe(CommandLine& line) override {
    line.text("PROTOCOL", options_.protocol, kProtocolHelp).required();
    line.texts("HEX", options_.hex, "The frame's bytes; from standard input when there are none");
    line.flag("--json", options_.json, "One JSON object");
  }
  ExitCode run(const Streams& streams) override {
    return inspect(options_, streams.in, streams.out, streams.err, streams.wide_screen());
  }
};

}  // namespace

CommandEntry inspect_command();
CommandEntry inspect_command() {
  return {"inspect", "Explain a frame; needs no bridge", make_command<InspectCommand>};
}

}  // namespace fieldcast::cli
