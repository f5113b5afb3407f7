// Output and input of a screen as values, independent of the terminal.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "core/base/time.hpp"
#include "tools/cli/text/text_table.hpp"

namespace fieldcast::cli {

struct Span {
  std::string text;  // from shown()
  Tone tone = Tone::kPlain;
};

struct FrameLine {
  std::vector<Span> spans;  // together at most as wide as the screen
  bool inverse = false;     // the selected row, the heads of columns
};

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
