// Fuzzes `fieldcast inspect`: any text as hexadecimal, explained by any protocol, as lines and as
// JSON.
//
// Input: one byte that selects the protocol, then the text.
#include <cstdlib>
#include <sstream>

#include "core/base/bytes.hpp"
#include "core/protocol/families/registry.hpp"
#include "tests/fuzz/fuzz.hpp"
#include "tools/cli/command/line/inspect.hpp"

namespace fieldcast {
namespace {

void run_one(ByteView data) {
  if (data.empty()) return;
  static const std::vector<std::string> names = [] {
    std::vector<std::string> all{"instrument", "modbus-rtu-declared", "dlt645-2007",
                                 "mt-sics",    "iec62056-21",         "m-bus"};
    for (const ProtocolEntry& entry : protocols()) all.emplace_back(entry.name);
    return all;
  }();
  const std::string hex(data.begin() + 1, data.end());
  for (const bool json : {false, true}) {
    std::istringstream in(hex);
    std::ostringstream out, err;
    const auto code = cli::inspect({.protocol = names[data[0] % names.size()], .json = json},
                                   cli::Streams{in, out, err});
    const bool refused = code == cli::ExitCode::kUsage;
    if (refused != out.str().empty() || refused == err.str().empty()) std::abort();
    // No control character of a frame may reach the terminal.
    for (const char c : out.str()) {
      if (static_cast<unsigned char>(c) < 0x20 && c != '\n') std::abort();
    }
  }
}

}  // namespace
}  // namespace fieldcast

FIELDCAST_FUZZ_TARGET(fieldcast::run_one)
