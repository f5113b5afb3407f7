// Data files of SLC 500 and MicroLogix controllers, and their notation.
#pragma once

#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

#include "core/protocol/option_reader.hpp"

namespace fieldcast::df1 {

// One type of file. Its area has the items of all its files, one file after the other.
struct FileRow {
  std::string_view name;    // letters of the notation
  std::uint8_t code = 0;    // file type (1770-6.5.16, 7-17; L as MicroLogix uses it)
  unsigned item_bits = 16;  // of an element or of its words
  std::optional<ValueType> type{};
  unsigned words = 1;  // of an element: 3 for timers, counters and controls, 32 for slots
  std::optional<std::uint8_t> file{};  // if the type has one file only
  std::uint32_t elements = 1000;       // of a file; an SLC 500 has 256

  [[nodiscard]] std::uint32_t file_items() const { return elements * words; }
  [[nodiscard]] bool by_slot() const { return words == 32; }
};

inline constexpr std::uint32_t kMaxRead = 236, kMaxWrite = 234;  // bytes (1770-6.5.16, 7-17)

[[nodiscard]] std::span<const FileRow> file_rows();

// In the order of file_rows(). `bytes`: limit of one request.
[[nodiscard]] std::vector<Area> areas_of(std::uint32_t bytes);

// Address fields of a request.
struct Place {
  std::uint32_t bytes = 0, file = 0, element = 0, sub = 0;
};
// A read of a timer, counter or control reads whole elements.
[[nodiscard]] Place place_of(const FileRow& row, const Range& range, bool write);

// "N7:0", "N7:0/3", "B3/21", "F8:3", "L9:0", "T4:0.ACC", "T4:0/DN", "S:1", "O:0.0", "I:1.0/3".
[[nodiscard]] ParsedOrFault parse_address(std::string_view at);

}  // namespace fieldcast::df1
