// Names of the commands (SH-080008, 8.1), for the explanation of frames.
#pragma once

#include <algorithm>
#include <cstdint>
#include <string_view>
#include <utility>

namespace fieldcast::mitsubishi_mc {

using NamedCommand = std::pair<std::uint32_t, std::string_view>;
inline constexpr NamedCommand kCommands[] = {{0x0101, "read CPU model"},
                                             {0x0401, "batch read"},
                                             {0x0403, "random read"},
                                             {0x0406, "read blocks"},
                                             {0x0619, "loopback test"},
                                             {0x0801, "register monitor data"},
                                             {0x0802, "monitor"},
                                             {0x1001, "remote run"},
                                             {0x1002, "remote stop"},
                                             {0x1401, "batch write"},
                                             {0x1402, "random write"},
                                             {0x1406, "write blocks"},
                                             {0x1617, "clear error"},
                                             {0x1630, "remote password unlock"},
                                             {0x1631, "remote password lock"}};

// Empty for a command without a name.
[[nodiscard]] constexpr std::string_view command_name(std::uint32_t command) {
  const auto row = std::ranges::find(kCommands, command, &NamedCommand::first);
  return row != std::end(kCommands) ? row->second : std::string_view{};
}

}  // namespace fieldcast::mitsubishi_mc
