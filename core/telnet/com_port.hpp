// Messages of the Telnet COM-PORT-OPTION (RFC 2217). Plain values. Pure.
//
//     IAC SB 44 kind value IAC SE        client; a server sends kind + 100
//
//     kind  value
//     0     text                         signature; empty: request for the peer's
//     1     rate(4), big-endian          0: request. Older Cisco servers use a code of one byte
//     2     5 to 8                       data bits; 0: request
//     3     1 none, 2 odd, 3 even,       parity; 0: request
//           4 mark, 5 space
//     4     1 one, 2 two, 3 one and half stop bits; 0: request
//     5     see Control
//     6, 7  state                        NOTIFY-LINESTATE, NOTIFY-MODEMSTATE, of a server
//     8, 9  (empty)                      FLOWCONTROL-SUSPEND, FLOWCONTROL-RESUME
//     10,11 mask                         SET-LINESTATE-MASK, SET-MODEMSTATE-MASK
//     12    1 received, 2 unsent, 3 both PURGE-DATA
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <string_view>

#include "core/base/bytes.hpp"
#include "core/frame/line.hpp"

namespace fieldcast::telnet {

enum class Kind : std::uint8_t {
  kSignature,
  kBaud,
  kDataBits,
  kParity,
  kStopBits,
  kControl,
  kLineState,
  kModemState,
  kSuspend,
  kResume,
  kLineStateMask,
  kModemStateMask,
  kPurge,
};
inline constexpr std::uint8_t kLastKind = static_cast<std::uint8_t>(Kind::kPurge);
inline constexpr std::uint8_t kServerOffset = 100;
[[nodiscard]] std::string_view to_text(Kind kind);  // "baud rate"

// Values of Kind::kControl. 13 to 19 (flow control of one direction, and by DCD, DTR, DSR) are not
// supported.
enum class Control : std::uint8_t {
  kFlowRequest,
  kNoFlow,
  kSoftwareFlow,  // XON, XOFF
  kHardwareFlow,  // RTS, CTS
  kBreakRequest,
  kBreakOn,
  kBreakOff,
  kDtrRequest,
  kDtrOn,
  kDtrOff,
  kRtsRequest,
  kRtsOn,
  kRtsOff,
};

enum class From : std::uint8_t { kClient, kServer };

struct Message {
  From from = From::kClient;
  Kind kind = Kind::kSignature;
  std::uint32_t value = 0;
  std::string text{};     // of a signature
  bool one_byte = false;  // a baud rate in the code of older Cisco servers
  friend bool operator==(const Message&, const Message&) = default;
};

// kBaud to kStopBits, kControl or kPurge.
struct LineChange {
  Kind kind = Kind::kBaud;
  std::uint32_t value = 0;
  friend bool operator==(const LineChange&, const LineChange&) = default;
};

// Result of a LineChange: the value in force; empty if it is not known, or a control was refused.
using LineChangeDone = std::function<void(std::optional<std::uint32_t> in_force)>;

inline constexpr std::size_t kMaxSignature = 128;  // the rest is cut off

// Appends the frame. A baud rate without one-byte code is sent in four bytes.
void append_message(Bytes& out, const Message& message);
// `body`: the subnegotiation after the option. Empty if it is not a message of RFC 2217.
[[nodiscard]] std::optional<Message> message_from(ByteView body);

// The settings of a line.
inline constexpr Kind kSettings[] = {Kind::kBaud, Kind::kDataBits, Kind::kParity, Kind::kStopBits};

// Value of one of kSettings for a line.
[[nodiscard]] std::uint32_t value_of(Kind kind, const LineFormat& line);
// Returns false, without a change, if a line of this tree cannot have the value.
[[nodiscard]] bool set_value(LineFormat& line, Kind kind, std::uint32_t value);

}  // namespace fieldcast::telnet
