// What the lists of other programs come to: buses, devices and points, before they are written as a
// configuration. One form for all formats. Plain values.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/base/time.hpp"
#include "core/codec/value_codec.hpp"
#include "core/model/spec.hpp"

namespace fieldcast::importing {

// Of one import: more than a configuration may hold is never made, whatever a list multiplies.
inline constexpr std::size_t kMaxPoints = 100'000;

struct Origin {
  std::string file;
  unsigned line = 0;    // from 1; of a table of Excel: the row
  unsigned column = 0;  // of the cell that is wrong, from 1; 0: not of one cell
};

// A channel to be. Its numbers mean what those of a channel mean: value = raw * scale + offset.
struct Point {
  std::string name;    // as in the list; arrange() makes a channel's name of it
  std::string listed;  // the name in the list, once it was arranged
  Origin origin;
  std::string at;  // in our notation: "holding:100", "input-register:7.3"
  ValueType type = ValueType::kUint16;
  std::uint16_t string_bytes = 0;    // of a text
  std::optional<std::uint8_t> byte;  // of the register, for 8-bit types: 0 low, 1 high
  WordOrder word_order = WordOrder::kBigEndian;
  ByteOrder byte_order = ByteOrder::kBigEndian;
  double scale = 1, offset = 0;
  std::string unit, description;
  Access access = Access::kReadOnly;
  bool on_demand = false;  // read by command only
  std::optional<Duration> refresh;
  std::optional<double> low_low, low, high, high_high, hysteresis, deadband, write_min, write_max;
  std::vector<std::string> changes;  // what is not as in the list, a few words for each
};

struct Device {
  std::string name;
  std::optional<std::uint16_t> address;
  std::string description;
  std::optional<Duration> timeout, pause;
  std::optional<unsigned> retries, max_block, max_gap;
  bool write_multiple = false;  // functions 15 and 16 for single items too
  std::vector<Point> points;
  Origin origin;      // line 0: each point has a row of its own
  std::string fault;  // why nothing of it can be moved; empty: it can
};

struct Line {
  std::optional<std::uint32_t> baud;
  std::string format;  // "8N1"; empty: not said
};

// The baud rate that a program takes where its file says none.
struct UsualBaud {
  std::uint32_t baud = 0;  // 0: not known
  std::string_view program;
};

// Where a bus is; empty where the list does not say.
struct Port {
  std::string serial;  // a path
  std::string tcp;     // HOST:PORT
  Line line{};
  UsualBaud usual{};
};

struct Bus {
  std::string name;
  Port port;
  std::string protocol;  // "modbus-rtu"; empty: not said
  std::vector<Device> devices;
  Origin origin;      // line 0: unknown
  std::string fault;  // why nothing of it can be moved; empty: it can
};

// What cannot be moved, and why.
struct Refusal {
  std::string name;
  Origin origin;
  std::string reason;
};

// From which number the addresses of a file were taken to count, which it does not say itself.
struct BaseGuess {
  std::string file;
  unsigned base = 0;
  std::string reason;
};

struct Found {
  std::vector<Bus> buses;
  std::vector<Refusal> refusals;
  std::vector<std::string>
      notes;  // of the whole list: what was taken for granted, what is left out
  std::vector<BaseGuess> guesses;
};

}  // namespace fieldcast::importing
