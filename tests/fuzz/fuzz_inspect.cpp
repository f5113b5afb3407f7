// Fuzzes `fieldcast inspect`: any text as hexadecimal, explained by any protocol, as lines and as
// JSON.
//
// Input: a line with the protocol, then the text.
#include <algorithm>
#include <cstdlib>
#include <sstream>

#include "core/base/bytes.hpp"
#include "core/protocol/families/registry.hpp"
#include "tests/fuzz/fuzz.hpp"
#include "tools/cli/command/line/inspect.hpp"

namespace fieldcast {
namespace {

void run_one(ByteView data) {
  static const std::vector<std::string> names = [] {
    std::vector<std::string> all{"instrument", "modbus-rtu-declared", "dlt645-2007",
                                 "mt-sics",    "iec62056-21",         "m-bus"};
    for (const ProtocolEntry& entry : protocols()) all.emplace_back(entry.name);
    return all;
  }();
  const auto end = std::ranges::find(data, '\n');
  const std::string name(data.begin(), end);
  if (end == data.end() || !std::ranges::count(names, name)) return;
  const std::string hex(end + 1, data.end());
  for (const bool json : {false, true}) {
    std::istringstream in(hex);
    std::ostringstream out, err;
    const auto code = cli::inspect({.protocol = name, .json = json}, cli::Streams{in, out, err});
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
