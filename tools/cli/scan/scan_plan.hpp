// Requests of a scan and their order: lines (protocol, baud rate, format), and the addresses on
// each. Pure values and functions.
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <tl/expected.hpp>
#include <vector>

#include "core/base/time.hpp"
#include "core/frame/line.hpp"
#include "core/model/scan_question.hpp"
#include "tools/cli/model/address_notation.hpp"

namespace fieldcast::cli {

// Each probe waits `probe_wait` for the first byte of a response, the last one `last_probe_wait`. A
// response during the next probe still counts for the line.
struct ScanLine {
  NamedProtocol protocol;
  LineFormat format{};
  std::vector<std::uint16_t> addresses;
  std::map<std::string, std::string> options{};  // of the devices
  std::vector<std::uint16_t> probes{};           // empty: searches the line without probing
  Duration probe_wait{}, last_probe_wait{};
};

// The protocol for a device at `address`; null if it has no such address.
[[nodiscard]] std::unique_ptr<Protocol> scan_protocol(const NamedProtocol& named,
                                                      std::uint16_t address);
[[nodiscard]] std::unique_ptr<Protocol> scan_protocol(const NamedProtocol& named);
[[nodiscard]] std::unique_ptr<Protocol> scan_protocol(const ScanLine& line, std::uint16_t address);

// Usual settings of a protocol, most common first, after those of its factory. Only settings that
// match `baud` and `format` (bits, parity and stop).
[[nodiscard]] std::vector<LineFormat> usual_formats(const NamedProtocol& protocol,
                                                    std::optional<std::uint32_t> baud,
                                                    const std::optional<LineFormat>& format);

// "1-32", "1,2,10-12".
[[nodiscard]] tl::expected<std::vector<std::uint16_t>, std::string> addresses_from(
    std::string_view text);

// Whether a scan tries the usual links of the protocol's controllers in place of addresses.
[[nodiscard]] bool has_usual_links(const NamedProtocol& protocol);

// One line for each format, or for each usual link of a protocol of networks: its slot or TSAP, or
// the form of its frames. Omits addresses that the protocol does not have; a protocol with one
// device on its line is requested once.
[[nodiscard]] std::vector<ScanLine> scan_lines(const NamedProtocol& protocol,
                                               const std::vector<LineFormat>& formats,
                                               const std::vector<std::uint16_t>& addresses);

[[nodiscard]] inline std::vector<ScanQuestion> questions_of(const NamedProtocol& named,
                                                            const Protocol& protocol) {
  return scan_questions(protocol, named.declaration);
}

// Default limit for a scan of a silent line, for each protocol.
inline constexpr Duration kQuickScan = std::chrono::seconds{10};

// Idle time before the search of a line. Devices that separate messages by half a second of silence
// (as libmodbus does) discard bytes received at the previous speed.
inline constexpr Duration kScanRest = std::chrono::milliseconds{600};

// Duration of a search of all lines if no device responds.
[[nodiscard]] Duration silent_scan_time(const std::vector<ScanLine>& lines, Duration timeout);

// Selects the probes so that all lines together need at most kQuickScan for each protocol: as many
// addresses as fit with at least 10 ms for each response. The first address is probed last with the
// longest wait, because it is the most probable one.
void plan_probes(std::vector<ScanLine>& lines);

}  // namespace fieldcast::cli
