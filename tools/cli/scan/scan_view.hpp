// Formats the result of a scan as text, as JSON, and as a first configuration. Pure functions.
#pragma once

#include <string>
#include <vector>

#include "core/base/json.hpp"
#include "core/model/port_spec.hpp"
#include "tools/cli/scan/scanner.hpp"
#include "tools/cli/text/output.hpp"
#include "tools/progress/progress_line.hpp"

namespace fieldcast::cli {

// "modbus-rtu 9600 8N1"; for a TCP port with the options, "mitsubishi-mc { frame: 4e }".
[[nodiscard]] std::string line_text(const ScanLine& line, bool serial);

// "scanning: 11 %, 65s left at most, 2 found; modbus-rtu 9600 8N1, address 12". Assumes that no
// further device responds.
[[nodiscard]] ProgressText scan_progress(const Scanner& scanner, Duration elapsed, bool serial);

[[nodiscard]] std::vector<std::string> found_lines(const Scanner& scanner, bool serial,
                                                   const Screen& screen);
// "address 3: template: siemens-pac3200", and how to use a template; empty if none matches.
[[nodiscard]] std::vector<std::string> template_lines(const Scanner& scanner);
// For a quick search without any received byte: the probed lines, what to check, and the duration
// of a search with --all and `timeout`.
[[nodiscard]] std::vector<std::string> silence_lines(const std::string& port,
                                                     const Scanner& scanner, bool serial,
                                                     Duration timeout);
// {"port", "protocol", "baud", "format", "address", "options" (if any),
// "answer", "device_code", "answer_time", "identity", "sunspec" (only if it has SunSpec models:
// sunspec_json())}; response_time in nanoseconds.
[[nodiscard]] Json found_json(const std::string& port, const ScanLine& line, const ScanFound& found,
                              bool serial);

// A configuration for fieldcast-bridge: one bus, each device with the points of its SunSpec models,
// otherwise with the requested channel. `server`: HOST:PORT is a serial server, and the format of
// the scanned line is that of the line behind it. REQUIRES: a device was found.
[[nodiscard]] std::string configuration_text(const std::string& port, bool serial,
                                             const Scanner& scanner, bool server = false);

}  // namespace fieldcast::cli
