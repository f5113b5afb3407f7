// Statistics of bytes that arrive instead of a device's responses, and a diagnosis: they show a
// wrong baud rate or parity. One per device, owned by DeviceMonitor, on the bus's thread.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <string_view>

#include "core/base/bytes.hpp"
#include "core/frame/line.hpp"

namespace fieldcast {

// Similarity of a broken response to the expected one. kOther: different or of unknown length.
enum class ResponseShape : std::uint8_t { kOther, kCut, kWhole, kLong };

// Compares bytes with the first two characters of the request, which Modbus and Host Link repeat,
// and with the `expected` length of the response (0: unknown).
[[nodiscard]] ResponseShape response_shape(ByteView bytes, ByteView request, std::size_t expected);

// Diagnosis and fix as one clause for users. REQUIRES: not kOther.
[[nodiscard]] std::string_view broken_response_text(ResponseShape shape);

class Garbage {
 public:
  // Consecutive broken responses before a report; a single one is noise.
  static constexpr unsigned kWorthSaying = 3;
  static constexpr std::size_t kShown = 16;
  static constexpr std::size_t kKept = 128;  // last bytes, kept for the diagnosis

  // Returns true if text() should be reported now. `expected`: response length; 0 if unknown.
  [[nodiscard]] bool received(ByteView bytes, ByteView request, std::size_t expected);
  // Returns true if text() was reported before.
  bool responded();

  // One line with the number of bytes, the last ones, the diagnosis and the fix.
  // `line`: null for a connection without a serial line.
  [[nodiscard]] std::string text(const LineFormat* line, bool over_network) const;

 private:
  [[nodiscard]] ResponseShape shape() const;

  unsigned exchanges_ = 0;
  std::uint64_t bytes_ = 0;
  bool echo_ = true;  // each was the request or a part of it
  std::array<unsigned, 4> shapes_{};
  Bytes last_;
};

// Diagnoses unexpected bytes on this line: one clause with a fix. REQUIRES: not empty.
[[nodiscard]] std::string looks_like(ByteView bytes, const LineFormat& line, bool over_network);

}  // namespace fieldcast
