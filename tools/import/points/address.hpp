#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "tools/import/points/model.hpp"
#include "tools/import/text/text.hpp"

namespace fieldcast::importing {

enum class ModbusArea : std::uint8_t { kCoil, kInput, kInputRegister, kHolding };

[[nodiscard]] constexpr bool holds_bits(ModbusArea area) {
  return area == ModbusArea::kCoil || area == ModbusArea::kInput;
}
[[nodiscard]] constexpr bool can_be_written(ModbusArea area) {
  return area == ModbusArea::kCoil || area == ModbusArea::kHolding;
}

// "holding:100", "holding:100.5".
[[nodiscard]] std::string address_text(ModbusArea area, std::uint64_t first,
                                       std::optional<std::uint8_t> bit = {});

[[nodiscard]] std::optional<ModbusArea> area_of_digit(char digit);

// Table of a word: "Holding Register", "4x", "AI", "input", "03", "FC4".
[[nodiscard]] std::optional<ModbusArea> area_by_name(std::string_view name);

// The same for words only: in a column of types, "4" or "3 bananas" may mean anything.
[[nodiscard]] bool is_area_word(std::string_view name);

// Empty if the cell is empty. The loader checks the range. The error is the reason.
using Slave = Result<std::optional<std::uint16_t>>;
[[nodiscard]] Slave slave_from(std::string_view text);

// "40101", "400101", "4x0101", "4:101", "30007.3", "%MW100", "HR100".
struct Reference {
  std::optional<ModbusArea> area;  // empty: a plain number
  std::uint32_t first = 0;         // counted from 0
  std::optional<std::uint8_t> bit;
};
// `base`: number of the first register in "40001" and "4x0001". The error is the reason.
[[nodiscard]] Result<Reference> reference_from(std::string_view text, unsigned base = 1);

// Appends one point for 0 elements, or an array at consecutive addresses: NAME-0, NAME-1, ..
// Stops one point above kMaxPoints.
void append_points(std::vector<Point>& points, Point point, ModbusArea area, std::uint32_t address,
                   unsigned elements);

}  // namespace fieldcast::importing
