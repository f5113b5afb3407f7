#pragma once

#include <cstdint>

#include "core/base/bytes.hpp"

namespace fieldcast::s7_tcp {

inline constexpr std::size_t kTpktHeader = 4, kDataHeader = kTpktHeader + 3;
inline constexpr std::size_t kConfirmation = 22;  // bytes of a confirmed connect

enum class Tpdu : std::uint8_t {
  kRefusal = 0x80,
  kConfirm = 0xD0,
  kConnect = 0xE0,
  kData = 0xF0,
};

// The frame at the beginning of received bytes.
struct IsoFrame {
  enum class Kind : std::uint8_t { kPart, kHopeless, kWhole };
  Kind kind = Kind::kPart;
  std::size_t size = 0;
  Tpdu type = Tpdu::kData;
  ByteView message;  // with kData
};
// `most`: bytes of the longest frame.
[[nodiscard]] IsoFrame first_iso_frame(ByteView bytes, std::size_t most);

void append_connect(Bytes& out, std::uint16_t local_tsap, std::uint16_t tsap);
void append_data(Bytes& out, ByteView message);

}  // namespace fieldcast::s7_tcp
