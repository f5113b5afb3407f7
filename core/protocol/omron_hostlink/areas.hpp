// Memory areas of Omron PLCs in the two command sets of a Host Link port, and their notation.
#pragma once

#include <cstdint>
#include <string_view>
#include <vector>

#include "core/protocol/protocol.hpp"

namespace fieldcast::omron {

// C-mode: two-letter commands of every Host Link PLC. FINS in Host Link (header FA): CS, CJ, CP and
// later.
// kFinsEthernet: the same with longer messages.
enum class Mode : std::uint8_t { kCMode, kFins, kFinsEthernet };

// One area. Zero in a column means that this command set cannot reach it.
struct AreaRow {
  std::string_view name;
  std::string_view other;      // second spelling: "D"
  char letter = 0;             // C-mode commands: R + letter reads, W + letter writes
  std::uint32_t c_items = 0;   // reachable with four decimal digits
  std::uint8_t word_code = 0;  // FINS area codes of CS/CJ/CP (Omron W342, 5-2-2)
  std::uint8_t bit_code = 0;
  std::uint32_t fins_items = 0;
  std::uint32_t c_offset = 0;                      // C-mode counters follow the timers, from 2048
  std::uint32_t fins_offset = 0;                   // FINS counters follow the timers, from 8000h
  bool flags = false;                              // one bit each
  std::optional<ValueType> c_type = std::nullopt;  // see Area::type, in C-mode
};

inline constexpr std::uint32_t kBankWords = 32768;  // of EM; address = bank * kBankWords + word
inline constexpr std::uint32_t kBanks = 13;         // 0 to C

// Returns true for EM, whose word and bit codes contain the bank.
[[nodiscard]] bool is_extended(const AreaRow& row);

// What one command set reaches, in the order of Protocol::areas().
struct Reached {
  std::vector<const AreaRow*> rows;
  std::vector<Area> areas;
};
[[nodiscard]] const Reached& reached_in(Mode mode);

// "DM100", "CIO12.03", "W5", "HR10", "AR3", "LR7", "T5", "C5", "TF5", "E1_100".
[[nodiscard]] tl::expected<ParsedAddress, AddressFault> parse_address(Mode mode,
                                                                      std::string_view at);

}  // namespace fieldcast::omron
