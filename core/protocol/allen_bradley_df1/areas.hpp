// Data files of SLC 500 and MicroLogix controllers, and their notation.
#pragma once

#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

#include "core/protocol/option_reader.hpp"

namespace fieldcast::df1 {

// One type of file. A file is a bank of its area: item = file * bank + word. Files 0, 1 and 2 hold
// outputs, inputs and status; other types have any number.
struct FileRow {
  std::string_view name;  // letters of the notation
  std::uint8_t code = 0;  // file type (1770-6.5.16, 7-17; L as MicroLogix uses it)
  unsigned item_bits = 16;
  std::optional<std::uint8_t> file{};  // if the type has one file only
  std::uint32_t bank = 0;              // items of one file, or of one slot
  unsigned words = 1;                  // of an element: 3 for timers, counters and controls
  bool by_slot = false;                // the element is a slot, the sub-element its word
  bool writable = true;
  std::optional<ValueType> type{};
};

inline constexpr std::uint32_t kElements = 1000;  // of a file; an SLC 500 has 256
inline constexpr std::uint32_t kSlots = 31, kSlotWords = 32;
inline constexpr std::uint32_t kMaxRead = 236, kMaxWrite = 234;  // bytes (1770-6.5.16, 7-17)

[[nodiscard]] std::span<const FileRow> file_rows();
[[nodiscard]] const FileRow* row_of_code(std::uint8_t code);

// In the order of file_rows(). `bytes`: limit of one request.
[[nodiscard]] std::vector<Area> areas_of(std::uint32_t bytes);

// What a request contains in its address fields.
struct Place {
  std::uint32_t bytes = 0;
  std::uint32_t file = 0, element = 0, sub = 0;
};
// A read of a timer, counter or control reads whole elements.
[[nodiscard]] Place place_of(const FileRow& row, const Range& range, bool write);

// "N7:0", "N7:0/3", "B3/21", "F8:3", "L9:0", "T4:0.ACC", "T4:0/DN", "S:1", "O:0.0", "I:1.0/3".
[[nodiscard]] ParsedOrFault parse_address(std::string_view at);

// "N7:0", for explanations.
[[nodiscard]] std::string text_of(const FileRow& row, const Place& place);

}  // namespace fieldcast::df1
