// Commands of 1C frames (SH-080008, chapter 18; of FX: data communication edition of the user's
// manual, JY997D16901, part D, 7), from the command on. A point count of 256 is 00.
//
//     BR JR  read bits     command(2) wait(1) device points(2)         ->  a digit for a bit
//     WR QR  read words    command(2) wait(1) device points(2)         ->  four digits for a word
//     BW JW  write bits    command(2) wait(1) device points(2) digits  ->  no data
//     WW QW  write words   the same                                    ->  no data
//     device               BR ..: letter number(4), or letters number(3); JR ..: two digits more
#pragma once

#include <optional>

#include "core/protocol/mitsubishi_mc/areas.hpp"
#include "core/protocol/mitsubishi_mc/command.hpp"

namespace fieldcast::mitsubishi_mc {

enum class ShortCommands : std::uint8_t {
  kA,    // BR ..: all PLCs
  kAna,  // JR ..: longer numbers
  kFx    // BR .., with octal numbers of X and Y
};

[[nodiscard]] const Reached& reached_by(ShortCommands set);
[[nodiscard]] tl::expected<ParsedAddress, AddressFault> parse_address(ShortCommands set,
                                                                      std::string_view at);

// See command.hpp.
[[nodiscard]] std::optional<CommandSizes> command_sizes(ShortCommands set, const Request& request);
void append_command(Bytes& out, ShortCommands set, const Request& request);
[[nodiscard]] std::optional<Reply> unpack(ByteView data, ShortCommands set, const Request& request);

}  // namespace fieldcast::mitsubishi_mc
