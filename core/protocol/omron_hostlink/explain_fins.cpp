#include "core/protocol/omron_hostlink/explain_fins.hpp"

#include <algorithm>
#include <string>
#include <string_view>
#include <utility>

#include "core/codec/digits.hpp"
#include "core/protocol/omron_hostlink/fins.hpp"

namespace fieldcast::omron {
namespace {

using NamedCommand = std::pair<std::uint16_t, std::string_view>;
constexpr NamedCommand kFinsCommands[] = {{0x0101, "memory area read"},
                                          {0x0102, "memory area write"},
                                          {0x0103, "memory area fill"},
                                          {0x0104, "multiple memory area read"},
                                          {0x0105, "memory area transfer"},
                                          {0x0306, "program area read"},
                                          {0x0307, "program area write"},
                                          {0x0308, "program area clear"},
                                          {0x0401, "run"},
                                          {0x0402, "stop"},
                                          {0x0501, "CPU unit data read"},
                                          {0x0601, "CPU unit status read"},
                                          {0x0620, "cycle time read"},
                                          {0x0701, "clock read"}};

std::string command_text(std::uint16_t command) {
  const std::uint8_t bytes[]{static_cast<std::uint8_t>(command >> 8),
                             static_cast<std::uint8_t>(command)};
  std::string text = to_hex(bytes, '\0');
  const auto row = std::ranges::find(kFinsCommands, command, &NamedCommand::first);
  return row == std::end(kFinsCommands) ? text : text + " " + std::string(row->second);
}

}  // namespace

void explain_fins(ByteView bytes, bool request, FieldWriter& out) {
  const std::size_t head = !bytes.empty() && (bytes[0] & 0x80) != 0 ? 10 : 4;
  const std::size_t least = head + (request ? 2 : 4);
  if (bytes.size() < least) return out.add(0, bytes.size(), "message", to_hex(bytes), "too short");
  const bool response_flag = (bytes[0] & 0x40) != 0;
  out.add(0, 1, "ICF", to_hex(bytes.first(1)) + (response_flag ? " response" : " request"),
          response_flag != request ? "" : "the other direction's flag");
  out.add(1, head - 2, head == 4 ? "DA2 SA2" : "RSV GCT DNA DA1 DA2 SNA SA1 SA2",
          to_hex(bytes.subspan(1, head - 2)));
  out.add(head - 1, 1, "SID", to_hex(bytes.subspan(head - 1, 1)));
  out.add(head, 2, "command", command_text(read_u16(bytes, head)));
  if (!request) {
    const std::uint16_t end = read_u16(bytes, head + 2);
    out.add(
        head + 2, 2, "end code",
        to_hex(bytes.subspan(head + 2, 2), '\0') + " " + std::string(fins_end_text(end & 0x7F3F)));
  }
  if (bytes.size() > least)
    out.add(least, bytes.size() - least, request ? "parameters" : "data",
            to_hex(bytes.subspan(least)));
}

}  // namespace fieldcast::omron
