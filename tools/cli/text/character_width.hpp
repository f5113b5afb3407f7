// Widths of characters in the cells of a terminal. Only for tools/cli/text, and for the file of
// Windows that takes the place of character_width.cpp.
#pragma once

namespace fieldcast::cli {

// Uses the C library's character widths of a Unicode locale, independent of the user's locale. One
// instance at a time in a thread.
class WidthsOfUnicode {
 public:
  WidthsOfUnicode();
  ~WidthsOfUnicode();
  WidthsOfUnicode(const WidthsOfUnicode&) = delete;
  WidthsOfUnicode& operator=(const WidthsOfUnicode&) = delete;

  // Returns 0 to 2; negative for a character that is not printable.
  [[nodiscard]] int of(char32_t c) const;

 private:
  void* before_;  // the locale that the destructor restores
};

}  // namespace fieldcast::cli
