// Fuzzes `fieldcast inspect` with captures and pasted lines of a trace, with values by a
// configuration.
//
// Input: a capture if the bytes begin as one, else text.
#include <cstdlib>
#include <sstream>

#include "tests/fuzz/fuzz.hpp"
#include "tools/cli/inspect/frame_report.hpp"

namespace fieldcast {
namespace {

DeviceSpec device(const std::string& name, const std::string& protocol, std::uint16_t address) {
  DeviceSpec made{.name = name, .protocol = protocol};
  made.link.address = address;
  for (std::uint32_t i = 0; i < 4; ++i) {
    ChannelSpec channel{.name = "c" + std::to_string(i)};
    channel.range = {0, 8 * i, 1};
    made.channels.push_back(channel);
  }
  return made;
}

const BridgeSpec& plant() {
  static const BridgeSpec spec = [] {
    BridgeSpec made;
    made.buses.push_back({.name = "yard", .port = SerialPortSpec{"/dev/yard"}});
    made.buses.back().devices = {device("fan", "modbus-rtu", 3), device("gate", "s7-freeport", 1),
                                 device("packer", "s7-ppi", 2), device("mixer", "dtc", 1)};
    return made;
  }();
  return spec;
}

void run_capture_input(ByteView data) {
  const std::string text(data.begin(), data.end());
  for (const bool json : {false, true}) {
    std::ostringstream out, err;
    cli::FrameReport report({.json = json, .fields = !json, .spec = &plant()}, out, {});
    std::istringstream in(text);
    if (cli::is_capture(in)) {
      (void)cli::show_capture(in, "fuzz.pcapng", report, err);
      if (err.str().empty()) std::abort();
    } else if (!cli::show_trace(text, report) && report.frames() > 0) {
      std::abort();
    }
    // No control character from outside may reach the terminal.
    for (const char c : out.str() + err.str()) {
      if (static_cast<unsigned char>(c) < 0x20 && c != '\n') std::abort();
    }
  }
}

}  // namespace
}  // namespace fieldcast

FIELDCAST_FUZZ_TARGET(fieldcast::run_capture_input)
