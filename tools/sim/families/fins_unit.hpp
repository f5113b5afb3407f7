// Areas of an Omron PLC and their addresses in FINS and C-mode. Independent of the bridge's tables.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string_view>
#include <vector>

#include "tools/sim/device/device.hpp"
#include "tools/sim/device/item_memory.hpp"

namespace fieldcast::sim {

inline constexpr std::array<std::string_view, 11> kOmronAreaNames{
    "CIO", "W", "LR", "HR", "AR", "DM", "EM", "T", "C", "TF", "CF"};
inline constexpr std::uint32_t kEmBankWords = 32768;

// A zero means that the protocol cannot access the area.
struct OmronArea {
  unsigned bits;           // of one item
  std::uint32_t items;     // of a bank, in FINS
  char letter;             // of the C-mode commands R_ and W_
  std::uint32_t c_first;   // C-mode number of the first item
  std::uint32_t c_items;   // of a bank, in C-mode
  std::uint8_t word_code;  // FINS; of the first EM bank
  std::uint8_t bit_code;
  std::uint32_t fins_first;  // FINS number of the first item
};
inline constexpr std::array<OmronArea, 11> kOmronAreas{{
    {16, 6144, 'R', 0, 10000, 0xB0, 0x30, 0},
    {16, 512, 0, 0, 0, 0xB1, 0x31, 0},
    {16, 0, 'L', 0, 200, 0, 0, 0},
    {16, 1536, 'H', 0, 1536, 0xB2, 0x32, 0},
    {16, 960, 'J', 0, 960, 0xB3, 0x33, 0},
    {16, 32768, 'D', 0, 10000, 0x82, 0x02, 0},
    {16, kEmBankWords, 'E', 0, 10000, 0xA0, 0x20, 0},
    {16, 4096, 'C', 0, 2048, 0x89, 0, 0},
    {16, 4096, 'C', 2048, 2048, 0x89, 0, 0x8000},
    {1, 4096, 'G', 0, 2048, 0, 0x09, 0},
    {1, 4096, 'G', 2048, 2048, 0, 0x09, 0x8000},
}};
inline constexpr std::size_t kOmronEm = 6, kOmronEmBanks = 13, kOmronCModeBanks = 10;

[[nodiscard]] std::vector<ItemArea> omron_areas();

// "DM100", "CIO12.03", "E1_100", "TF5".
[[nodiscard]] std::optional<ItemAddress> parse_omron_address(std::string_view at);

// A simulated Omron PLC on the level of FINS messages (Omron W342). Does not own the PLC's memory.
//
//     direct    ICF 00, DA2, SA2, SID, command(2), text
//     response  ICF 40, the same, command, end code(2), data
//     relayed   ICF 80, RSV, GCT, destination(3), source(3), SID, command(2), text
//     response  ICF C0, source and destination exchanged
class FinsUnit {
 public:
  // By the carrier of the messages; the default is that of Host Link.
  struct Limits {
    std::size_t response = 538;  // bytes
    std::size_t items = 128;     // of command 0104
  };

  FinsUnit(ItemMemory& memory, DeviceStatistics& statistics) : FinsUnit(memory, statistics, {}) {}
  FinsUnit(ItemMemory& memory, DeviceStatistics& statistics, const Limits& limits)
      : memory_(memory), statistics_(statistics), limits_(limits) {}

  [[nodiscard]] Bytes execute(ByteView message, Instant now);

 private:
  struct Address {
    std::size_t area = 0;
    std::uint32_t first = 0;
    std::optional<std::uint8_t> bit;  // bit of a word: `count` counts bits
  };
  struct Result {
    std::uint16_t end = 0;
    Bytes data;
  };
  [[nodiscard]] static std::optional<Address> address_of(ByteView area_and_address);
  [[nodiscard]] std::uint16_t refusal(const Address& address, std::uint32_t count) const;
  [[nodiscard]] static std::size_t item_size(const Address& address);
  void append_items(const Address& address, std::uint32_t count, Instant now, Bytes& out) const;
  void store(const Address& address, std::uint32_t count, ByteView data, Instant now);

  [[nodiscard]] Result dispatch(std::uint16_t command, ByteView text, Instant now);
  [[nodiscard]] Result read(ByteView text, Instant now) const;
  [[nodiscard]] Result write(ByteView text, Instant now);
  [[nodiscard]] Result fill(ByteView text, Instant now);
  [[nodiscard]] Result read_many(ByteView text, Instant now) const;
  [[nodiscard]] Result transfer(ByteView text, Instant now);
  [[nodiscard]] static Result cpu_data(ByteView text);

  ItemMemory& memory_;
  DeviceStatistics& statistics_;
  const Limits limits_;
  std::uint8_t mode_ = 2;  // 0 PROGRAM, 2 MONITOR, 4 RUN
};

}  // namespace fieldcast::sim
