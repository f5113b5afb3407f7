// Imported data in a common form for all formats. Plain values.
#pragma once

#include <fmt/format.h>

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "core/base/time.hpp"
#include "core/codec/value_codec.hpp"
#include "core/model/channel_kind.hpp"

namespace fieldcast::importing {

// Limit of one import, which arrays of a list cannot exceed.
inline constexpr std::size_t kMaxPoints = 100'000;

struct Origin {
  std::string file;
  unsigned line = 0;    // from 1; in Excel the row
  unsigned column = 0;  // of the invalid cell, from 1; 0: not one cell
};

// A future channel: value = raw * scale + offset.
struct Point {
  std::string name;    // as in the list; arrange() converts it to a channel name
  std::string listed;  // name in the list, set by arrange()
  Origin origin;
  std::string at;  // in our notation: "holding:100", "input-register:7.3"
  ValueType type = ValueType::kUint16;
  std::uint16_t string_bytes = 0;    // of a text
  std::optional<std::uint8_t> byte;  // of the register, for 8-bit types: 0 low, 1 high
  std::optional<std::uint8_t> bit;   // of the register, for kBool; part of `at`
  WordOrder word_order = WordOrder::kBigEndian;
  ByteOrder byte_order = ByteOrder::kBigEndian;
  double scale = 1, offset = 0;
  std::string unit, description;
  Access access = Access::kReadOnly;
  bool on_demand = false;  // read by command only
  std::optional<Duration> refresh;
  std::optional<double> low_low, low, high, high_high, hysteresis, deadband, write_min, write_max;
  std::vector<std::string> changes;  // differences from the list, a few words each

  template <typename... Args>
  void change(fmt::format_string<Args...> text, Args&&... args) {
    changes.push_back(fmt::format(text, std::forward<Args>(args)...));
  }
  void set_orders(bool low_word_first, bool low_byte_first) {
    word_order = low_word_first ? WordOrder::kLittleEndian : WordOrder::kBigEndian;
    byte_order = low_byte_first ? ByteOrder::kLittleEndian : ByteOrder::kBigEndian;
  }
};

struct Device {
  std::string name;
  std::optional<std::uint16_t> address;
  std::string description;
  std::optional<Duration> timeout, pause;
  std::optional<unsigned> retries, max_block, max_gap;
  bool write_multiple = false;  // functions 15 and 16 also for single items
  std::vector<Point> points;
  Origin origin;      // line 0: each point has its own row
  std::string fault;  // reason to refuse all its points; empty: none
};

struct Line {
  std::optional<std::uint32_t> baud;
  std::string format;  // "8N1"; empty: unknown
};

struct UsualBaud {
  std::uint32_t baud = 0;  // 0: unknown
  std::string_view program;
};

struct Port {
  std::string serial;  // a path
  std::string tcp;     // HOST:PORT
  Line line{};
  UsualBaud usual{};
};

struct Bus {
  std::string name;
  Port port;
  std::string protocol;  // "modbus-rtu"; empty: unknown
  std::vector<Device> devices;
  Origin origin;      // line 0: unknown
  std::string fault;  // reason to refuse all its points; empty: none
};

struct Refusal {
  std::string name;
  Origin origin;
  std::string reason;
};

// Assumed number of the first address, if the file does not contain it.
struct BaseGuess {
  std::string file;
  unsigned base = 0;
  std::string reason;
};

struct Found {
  std::vector<Bus> buses;
  std::vector<Refusal> refusals;
  std::vector<std::string> notes;  // about the whole list: assumptions and omissions
  std::vector<BaseGuess> guesses;

  template <typename... Args>
  void note(fmt::format_string<Args...> text, Args&&... args) {
    notes.push_back(fmt::format(text, std::forward<Args>(args)...));
  }
  void refuse(std::string_view name, const Origin& origin, std::string reason) {
    refusals.push_back({std::string(name), origin, std::move(reason)});
  }
};

}  // namespace fieldcast::importing
