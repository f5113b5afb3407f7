// What a screen shows and what a person does at it, as values: nothing here knows a terminal.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "core/base/time.hpp"
#include "tools/cli/view/text_table.hpp"

namespace fieldcast::cli {

struct Span {
  std::string text;  // from shown()
  Tone tone = Tone::kPlain;
};

struct FrameLine {
  std::vector<Span> spans;  // together as wide as the screen at most
  bool inverse = false;     // the selected row, the heads of columns
};

struct Frame {
  std::vector<FrameLine> lines;                               // as high as the screen at most
  std::optional<std::pair<std::size_t, std::size_t>> cursor;  // row and column; nothing: hidden
};

// One moment by both clocks.
struct Moment {
  Instant now{};
  UtcTime utc{};
};

struct Key {
  enum class Kind : unsigned char {
    kText,  // one character that can be printed, UTF-8
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
    kRedraw,  // Ctrl-L, another size, or back from the background
  };
  Kind kind = Kind::kText;
  std::string text{};
  int number = 0;                   // of kFunction
  std::size_t row = 0, column = 0;  // of kClick
};

[[nodiscard]] inline Key text_key(std::string text) { return {Key::Kind::kText, std::move(text)}; }
[[nodiscard]] inline Key function_key(int number) { return {Key::Kind::kFunction, {}, number}; }

}  // namespace fieldcast::cli
