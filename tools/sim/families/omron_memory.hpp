// Areas of an Omron PLC and their addresses in FINS and C-mode. Independent of the bridge's tables.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string_view>
#include <vector>

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

}  // namespace fieldcast::sim
