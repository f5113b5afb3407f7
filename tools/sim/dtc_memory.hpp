// The variables of a simulated DTC device: five types of 65536, what was written, and the live values of its channels.
// Owned by one DtcDevice.
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <optional>
#include <string_view>
#include <vector>

#include "core/base/time.hpp"
#include "tools/sim/waveform.hpp"

namespace fieldcast::sim {

inline constexpr std::array<std::string_view, 5> kDtcAreaNames{"bit", "int16", "int32", "float32", "float64"};
inline constexpr std::array<unsigned, 5> kDtcBits{1, 16, 32, 32, 64};  // of one variable

// "int16:100" or "int16:100.3", read apart from the bridge's own parser.
struct DtcAddress {
  std::uint8_t type = 0;
  std::uint16_t first = 0;
  std::optional<std::uint8_t> bit;
};
[[nodiscard]] std::optional<DtcAddress> parse_dtc_address(std::string_view at);

class DtcMemory {
 public:
  static constexpr std::uint32_t kVariables = 65536;

  explicit DtcMemory(Instant start) : start_(start) {}

  // A configured channel: its variables follow the waveform until they are written. False: it does not fit into its type.
  bool add_channel(const DtcAddress& at, const Encoding& encoding, const Waveform& waveform);

  // The bits of a variable, right-aligned. REQUIRES: type < 5.
  [[nodiscard]] std::uint64_t read(std::uint8_t type, std::uint16_t variable, Instant now) const;
  // What is written stays.
  void write(std::uint8_t type, std::uint16_t variable, std::uint64_t bits) { written_[type][variable] = bits; }
  // True: some channel names this variable.
  [[nodiscard]] bool configured(std::uint8_t type, std::uint16_t variable) const { return parts_[type].contains(variable); }

 private:
  struct Channel {
    DtcAddress at;
    Encoding encoding;
    Waveform waveform;
  };
  struct Part {
    std::size_t channel = 0;
    unsigned index = 0;  // of the channel's variables
  };
  [[nodiscard]] std::uint64_t bits_of(const Part& part, unsigned width, Instant now) const;

  Instant start_;
  std::vector<Channel> channels_;
  std::array<std::multimap<std::uint16_t, Part>, 5> parts_;
  std::array<std::map<std::uint16_t, std::uint64_t>, 5> written_;
};

}  // namespace fieldcast::sim
