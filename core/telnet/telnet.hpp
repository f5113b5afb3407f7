// Telnet (RFC 854, RFC 855): splits a received stream into data and commands, and escapes data.
// Pure.
//
//     IAC IAC                            one data byte FF
//     IAC WILL|WONT|DO|DONT option       negotiation of an option
//     IAC SB option bytes IAC SE         subnegotiation; FF in it is sent twice
//     IAC code                           another command, ignored
#pragma once

#include <cstdint>
#include <optional>
#include <variant>

#include "core/base/bytes.hpp"

namespace fieldcast::telnet {

enum class Code : std::uint8_t {
  kSubnegotiationEnd = 240,
  kSubnegotiation = 250,
  kWill = 251,
  kWont = 252,
  kDo = 253,
  kDont = 254,
  kEscape = 255,
};

struct Data {
  ByteView bytes;  // refers to the input
};
struct OptionRequest {
  Code verb = Code::kWill;  // kWill to kDont
  std::uint8_t option = 0;
  friend bool operator==(const OptionRequest&, const OptionRequest&) = default;
};
struct Subnegotiation {
  std::uint8_t option = 0;
  Bytes bytes;
};
using Item = std::variant<Data, OptionRequest, Subnegotiation>;

// The stream may be split at any byte.
class Parser {
 public:
  // A longer subnegotiation is dropped. The longest that this tree reads is a signature.
  static constexpr std::size_t kMaxSubnegotiation = 256;

  // Consumes an item from the front of `in`, or all of `in` and returns empty.
  [[nodiscard]] std::optional<Item> next(ByteView& in);
  // Number of subnegotiations that were too long or did not end with IAC SE.
  [[nodiscard]] std::uint64_t dropped() const { return dropped_; }

 private:
  enum class State : std::uint8_t { kData, kEscape, kOption, kSubOption, kSub, kSubEscape };
  [[nodiscard]] ByteView data(ByteView& in);
  [[nodiscard]] std::optional<Item> command(std::uint8_t byte);
  [[nodiscard]] std::optional<Item> subnegotiation(std::uint8_t byte);
  void append(std::uint8_t byte);

  State state_ = State::kData;
  bool escaped_ = false;  // the next byte is the data byte FF
  bool overlong_ = false;
  Code verb_ = Code::kWill;
  Subnegotiation sub_;
  std::uint64_t dropped_ = 0;
};

void append_data(Bytes& out, ByteView data);
void append_request(Bytes& out, const OptionRequest& request);
void append_subnegotiation(Bytes& out, std::uint8_t option, ByteView bytes);

}  // namespace fieldcast::telnet
