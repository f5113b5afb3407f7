#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "core/protocol/protocol.hpp"

namespace fieldcast::mitsubishi_fx {

// Classic commands (every FX), or extended ones of FX3 and later, with their own address map.
enum class Commands : std::uint8_t { kClassic, kExtended };

struct AddressMap {
  std::uint32_t items = 0;             // 0 if not reachable
  std::uint32_t base = 0;              // byte address of item 0
  std::optional<std::uint32_t> force;  // bit address of item 0 for forcing
};

struct DeviceRow {
  std::string_view name;
  std::string_view other;   // second spelling, or empty
  unsigned item_bits = 16;  // 1, 16 or 32
  std::uint32_t first = 0;  // number of item 0: 8000 for special registers, 200 for 32-bit counters
  bool octal = false;       // X and Y
  std::optional<ValueType> type = std::nullopt;  // see Area::type
  AddressMap classic, extended;
  [[nodiscard]] const AddressMap& address_map(Commands commands) const {
    return commands == Commands::kClassic ? classic : extended;
  }
};

inline constexpr std::uint32_t kMaxBytes = 64;  // in one frame
inline constexpr std::uint8_t kStx = 0x02, kEtx = 0x03, kEnq = 0x05, kAck = 0x06, kNak = 0x15;

// What one set of commands reaches, in the order of Protocol::areas().
struct Reached {
  std::vector<const DeviceRow*> rows;
  std::vector<Area> areas;
};
[[nodiscard]] const Reached& reached_by(Commands commands);

// "D100", "D100.3", "D8010", "T5" (value), "TS5" (contact), "TC5" (coil), "C5", "C200", "M14",
// "M8001", "X17", "Y5" (octal), "S3".
[[nodiscard]] tl::expected<ParsedAddress, AddressFault> parse_address(Commands commands,
                                                                      std::string_view at);

}  // namespace fieldcast::mitsubishi_fx
