#include "core/telnet/com_port.hpp"

#include <algorithm>
#include <array>
#include <utility>

#include "core/telnet/options.hpp"

namespace fieldcast::telnet {
namespace {

struct KindRow {
  std::string_view text;
  std::size_t size;  // of the value; a signature has any
};
constexpr std::array<KindRow, kLastKind + 1> kKinds{{{"signature", 0},
                                                     {"baud rate", 4},
                                                     {"data bits", 1},
                                                     {"parity", 1},
                                                     {"stop bits", 1},
                                                     {"control", 1},
                                                     {"line state", 1},
                                                     {"modem state", 1},
                                                     {"suspend", 0},
                                                     {"resume", 0},
                                                     {"line state mask", 1},
                                                     {"modem state mask", 1},
                                                     {"purge", 1}}};

const KindRow& row_of(Kind kind) { return kKinds[static_cast<std::size_t>(kind)]; }

// Source: the table of the server ser2net, option cisco-baud-rates.
constexpr std::pair<std::uint8_t, std::uint32_t> kOneByteBauds[] = {
    {0, 0},    {3, 300},    {4, 600},    {5, 1200},   {6, 2400},    {7, 4800},
    {8, 9600}, {10, 19200}, {12, 38400}, {13, 57600}, {14, 115200}, {15, 230400}};

}  // namespace

std::string_view to_text(Kind kind) { return row_of(kind).text; }

void append_message(Bytes& out, const Message& message) {
  const bool of_server = message.from == From::kServer;
  Bytes body{static_cast<std::uint8_t>(static_cast<std::uint8_t>(message.kind) +
                                       (of_server ? kServerOffset : 0))};
  const auto* code =
      std::ranges::find(kOneByteBauds, message.value, [](const auto& row) { return row.second; });
  if (message.kind == Kind::kSignature) {
    const std::string_view text = std::string_view(message.text).substr(0, kMaxSignature);
    body.insert(body.end(), text.begin(), text.end());
  } else if (row_of(message.kind).size == 1) {
    body.push_back(static_cast<std::uint8_t>(message.value));
  } else if (message.one_byte && code != std::end(kOneByteBauds)) {
    body.push_back(code->first);
  } else if (message.kind == Kind::kBaud) {
    append_u32(body, message.value);
  }
  append_subnegotiation(out, kComPort, body);
}

std::optional<Message> message_from(ByteView body) {
  if (body.empty()) return std::nullopt;
  const bool of_server = body[0] >= kServerOffset;
  const auto code = static_cast<std::uint8_t>(of_server ? body[0] - kServerOffset : body[0]);
  if (code > kLastKind) return std::nullopt;
  Message message{of_server ? From::kServer : From::kClient, static_cast<Kind>(code)};
  const ByteView value = body.subspan(1);
  const std::size_t size = row_of(message.kind).size;
  if (message.kind == Kind::kSignature) {
    message.text.assign(value.begin(), value.begin() + static_cast<std::ptrdiff_t>(
                                                           std::min(value.size(), kMaxSignature)));
    return message;
  }
  if (message.kind == Kind::kBaud && value.size() == 1) {
    const auto* row = std::ranges::find(kOneByteBauds, value[0], [](auto r) { return r.first; });
    if (row == std::end(kOneByteBauds)) return std::nullopt;
    message.value = row->second;
    message.one_byte = true;
    return message;
  }
  // pyserial requests the modem state without a value.
  if (value.size() != size && !(size == 1 && value.empty())) return std::nullopt;
  if (size == 4) message.value = read_u32(value);
  if (size == 1 && !value.empty()) message.value = value[0];
  return message;
}

namespace {

constexpr Parity kParities[] = {Parity::kNone, Parity::kOdd, Parity::kEven};  // 1, 2, 3

}  // namespace

std::uint32_t value_of(Kind kind, const LineFormat& line) {
  switch (kind) {
    case Kind::kBaud: return line.baud;
    case Kind::kDataBits: return line.data_bits;
    case Kind::kParity:
      return static_cast<std::uint32_t>(std::ranges::find(kParities, line.parity) - kParities) + 1;
    case Kind::kStopBits: return line.stop_bits;
    default: return 0;
  }
}

bool set_value(LineFormat& line, Kind kind, std::uint32_t value) {
  const auto byte = static_cast<std::uint8_t>(value);
  switch (kind) {
    case Kind::kBaud: return value != 0 ? line.baud = value, true : false;
    case Kind::kDataBits: return value == 7 || value == 8 ? line.data_bits = byte, true : false;
    case Kind::kParity:
      return value >= 1 && value <= 3 ? line.parity = kParities[value - 1], true : false;
    case Kind::kStopBits: return value == 1 || value == 2 ? line.stop_bits = byte, true : false;
    default: return false;
  }
}

}  // namespace fieldcast::telnet
