// Commands of the MC protocol (SH-080008, 8.2 and 8.3), from the command on. The subcommand is 0
// for words, 1 for bits, and 2 more for the iQ-R series.
//
//     0401 read     device points(2)                           ->  words or bits
//     1401 write    device points(2) words or bits             ->  no data
//     0403 random   words(1) double words(1) device..          ->  words
//     device        binary: number(3) code(1), iQ-R: number(4) code(2); ASCII: code, number
//
// In bit units, a binary byte contains two bits, the first one in the high half, and ASCII code one
// digit for each. A word of bits has the lowest number in its lowest bit.
#pragma once

#include <cstdint>
#include <optional>

#include "core/protocol/mitsubishi_mc/areas.hpp"
#include "core/protocol/mitsubishi_mc/frame.hpp"
#include "core/protocol/protocol.hpp"

namespace fieldcast::mitsubishi_mc {

// Words of a random read (SH-080008, appendix 5).
[[nodiscard]] constexpr std::uint16_t max_random(const Format& format) {
  return format.wide ? 96 : 192;
}

struct CommandSizes {
  std::size_t request = 0;   // characters from the command on
  std::size_t response = 0;  // characters of data
  bool operator==(const CommandSizes&) const = default;
};
// Empty if the request exceeds a limit.
[[nodiscard]] std::optional<CommandSizes> command_sizes(const Format& format,
                                                        const Request& request);

// The number of command and subcommand.
[[nodiscard]] std::uint32_t command_of(const Format& format, const Request& request);

// REQUIRES for both: command_sizes(format, request) holds a value.
void append_command(Bytes& out, const Format& format, const Request& request);
// Empty if the data is not that of a response to the request.
[[nodiscard]] std::optional<Reply> unpack(ByteView data, const Format& format,
                                          const Request& request);

}  // namespace fieldcast::mitsubishi_mc
