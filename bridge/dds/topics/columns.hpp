// The columns that SampleBlock and HistoryBlock have in common: filled, compared and read in one
// place. Data from DDS is not trusted. Pure.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <utility>

#include "bridge/dds/topics/block.hpp"
#include "bridge/dds/topics/conversion.hpp"

namespace fieldcast {

template <class Block>
void clear_columns(Block& block) {
  block.channels().clear();
  block.kinds().clear();
  block.qualities().clear();
  block.device_codes().clear();
  block.values().clear();
  block.acquired_at().clear();
  block.sequences().clear();
  block.texts().clear();
}

template <class Block>
void add_columns(std::uint32_t channel, const LastValue& value, Block& block) {
  const bool is_text = value.kind == idl::ValueKind::VALUE_STRING;
  block.channels().push_back(channel);
  block.kinds().push_back(static_cast<std::uint8_t>(value.kind));
  block.qualities().push_back(static_cast<std::uint8_t>(value.quality));
  block.device_codes().push_back(value.device_code);
  block.values().push_back(is_text ? block.texts().size() : value.bits);
  block.acquired_at().push_back(value.acquired_at);
  block.sequences().push_back(value.sequence);
  if (is_text) block.texts().emplace_back(value.text);
}

// Returns true if each column has an element for each row. Does not compare acquired_at: a
// SampleBlock may have one for all rows.
template <class Block>
[[nodiscard]] bool has_whole_columns(const Block& block) {
  const std::size_t rows = block.channels().size();
  const auto fits = [rows](const auto& column) { return column.size() == rows; };
  return fits(block.kinds()) && fits(block.qualities()) && fits(block.values()) &&
         fits(block.sequences()) && (fits(block.device_codes()) || block.device_codes().empty());
}

// Fills value, quality and device_code of `out`. Returns false for an unknown kind, text or
// quality. REQUIRES: has_whole_columns(), row in range.
template <class Block, class Row>
[[nodiscard]] bool read_columns(const Block& block, std::size_t row, Row& out) {
  std::optional<Value> value = value_of(block.kinds()[row], block.values()[row], block.texts());
  const auto quality = from_idl(static_cast<idl::Quality>(block.qualities()[row]));
  if (!value || !quality) return false;
  out.value = *std::move(value);
  out.quality = *quality;
  out.device_code = block.device_codes().empty() ? std::uint16_t{0} : block.device_codes()[row];
  return true;
}

}  // namespace fieldcast
