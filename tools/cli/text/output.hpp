// Exit codes of `fieldcast`; part of the interface for scripts.
#pragma once

#include <cstddef>
#include <iosfwd>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "core/base/time.hpp"

namespace fieldcast::cli {

enum class ExitCode : int {
  kOk = 0,        // done, or verified
  kFound = 1,     // the input has a fault: an invalid frame, an infeasible plan
  kUsage = 2,     // invalid command line, or invalid file named there
  kNoBridge = 3,  // no bridge in this DDS domain
  kNothing = 4,   // a bridge exists, but nothing matches
  // A command was refused before it reached the wire: access, type, range, unknown channel, ...
  kRejected = 5,
  kFailed = 6,         // a command failed on the wire or in the device
  kExpired = 7,        // a command expired
  kNoResponse = 8,     // no result within the timeout
  kTrouble = 9,        // a fault of the machine: DDS cannot start, the output is closed
  kInterrupted = 130,  // Ctrl-C
};

[[nodiscard]] constexpr int to_int(ExitCode code) { return static_cast<int>(code); }

enum class Tone : unsigned char { kPlain, kFaint, kGood, kWarning, kBad, kTitle };
enum class Align : unsigned char { kLeft, kRight };

struct Cell {
  std::string text;
  Tone tone = Tone::kPlain;
};

// Size of a terminal; 0: no limit.
struct Screen {
  std::size_t columns = 0;
  std::size_t rows = 0;
  bool colour = false;
};

// Columns in a terminal; counts each code point as one column.
[[nodiscard]] std::size_t display_width(std::string_view utf8);

// Escapes control characters of untrusted text (core/base/message_text.hpp).
[[nodiscard]] std::string printable(std::string_view text);

[[nodiscard]] std::string clip(std::string_view utf8, std::size_t columns);

[[nodiscard]] std::string painted(std::string_view text, Tone tone, bool colour);

void print(std::ostream& out, const std::vector<std::string>& lines);

// Tables for terminals: column widths follow the longest cell, colours follow the role. Pure.
class TextTable {
 public:
  struct Column {
    std::string title;
    Align align = Align::kLeft;
  };
  explicit TextTable(std::vector<Column> columns) : columns_(std::move(columns)) {}

  void add_row(std::vector<Cell> cells);
  [[nodiscard]] std::size_t rows() const { return rows_.size(); }

  // One line for the titles and each row, truncated to the width. Ignores the height.
  [[nodiscard]] std::vector<std::string> render(const Screen& screen) const;

 private:
  std::vector<Column> columns_;
  std::vector<std::vector<Cell>> rows_;
};

struct Span {
  std::string text;  // from shown()
  Tone tone = Tone::kPlain;
};

struct FrameLine {
  std::vector<Span> spans;  // together at most as wide as the screen
  bool inverse = false;     // the selected row, the heads of columns
};

// Output and input of a screen as values, independent of the terminal.
struct Frame {
  std::vector<FrameLine> lines;                               // at most as high as the screen
  std::optional<std::pair<std::size_t, std::size_t>> cursor;  // row and column; empty: hidden
};

struct Moment {
  Instant now{};
  UtcTime utc{};
};

struct Key {
  enum class Kind : unsigned char {
    kText,  // one printable character, UTF-8
    kEnter,
    kEscape,
    kBackspace,
    kClear,  // Ctrl-U
    kUp,
    kDown,
    kLeft,
    kRight,
    kPageUp,
    kPageDown,
    kHome,
    kEnd,
    kFunction,  // F1 .. F12
    kClick,     // of the first button
    kWheelUp,
    kWheelDown,
    kRedraw,  // Ctrl-L, a new size, or return to the foreground
  };
  Kind kind = Kind::kText;
  std::string text{};
  int number = 0;                   // for kFunction
  std::size_t row = 0, column = 0;  // for kClick
};

[[nodiscard]] inline Key text_key(std::string text) { return {Key::Kind::kText, std::move(text)}; }
[[nodiscard]] inline Key function_key(int number) { return {Key::Kind::kFunction, {}, number}; }

}  // namespace fieldcast::cli
