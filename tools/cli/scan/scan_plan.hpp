// Requests of a scan and their order: lines (protocol, baud rate, format), and the addresses on
// each. Pure values and functions.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <tl/expected.hpp>
#include <vector>

#include "core/frame/line.hpp"
#include "tools/cli/model/named_protocol.hpp"

namespace fieldcast::cli {

// A request that changes nothing in any device: reads one item of an area.
struct ScanQuestion {
  std::string at;  // "holding:0"
  Range range;
};

struct ScanLine {
  NamedProtocol protocol;
  LineFormat format{};
  std::vector<std::uint16_t> addresses;
};

// The protocol for a device at `address`; null if it has no such address.
[[nodiscard]] std::unique_ptr<Protocol> scan_protocol(const NamedProtocol& named,
                                                      std::uint16_t address);
// The same for any device, to inspect its areas and codes.
[[nodiscard]] std::unique_ptr<Protocol> scan_protocol(const NamedProtocol& named);

// Usual settings of a protocol, most common first, after those of its factory. Only settings that
// match `baud` and `format` (bits, parity and stop).
[[nodiscard]] std::vector<LineFormat> usual_formats(const NamedProtocol& protocol,
                                                    std::optional<std::uint32_t> baud,
                                                    const std::optional<LineFormat>& format);

// "1-32", "1,2,10-12". The error is one line.
[[nodiscard]] tl::expected<std::vector<std::uint16_t>, std::string> addresses_from(
    std::string_view text);

// One line for each format. Omits addresses that the protocol does not have; a protocol with one
// device on its line is requested once.
[[nodiscard]] std::vector<ScanLine> scan_lines(const NamedProtocol& protocol,
                                               const std::vector<LineFormat>& formats,
                                               const std::vector<std::uint16_t>& addresses);

// One or two requests of different areas, because a device may ignore areas that it does not have.
// A declared record is read completely.
[[nodiscard]] std::vector<ScanQuestion> questions_of(const NamedProtocol& named,
                                                     const Protocol& protocol);

}  // namespace fieldcast::cli
