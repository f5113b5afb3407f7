#pragma once

#include <gtest/gtest.h>

#include <string>

#include "tools/cli/text/cell_text.hpp"
#include "tools/cli/text/output.hpp"

namespace fieldcast::cli {

[[nodiscard]] inline std::string text_of(const FrameLine& line) {
  std::string text;
  for (const Span& span : line.spans) text += span.text;
  text.erase(text.find_last_not_of(' ') + 1);
  return text;
}

[[nodiscard]] inline std::string text_of(const Frame& frame) {
  std::string text;
  for (const FrameLine& line : frame.lines) text += text_of(line) + '\n';
  return text;
}

// The text of the next frame of a screen, a second later. Fails the test if the frame does not fill
// the terminal.
template <typename Drawn>
[[nodiscard]] std::string next_frame(Drawn& screen, Moment& at, const Screen& size) {
  at.now += std::chrono::seconds{1};
  const Frame frame = screen.frame(at, size);
  EXPECT_EQ(frame.lines.size(), size.rows);
  for (const FrameLine& line : frame.lines) {
    std::size_t used = 0;
    for (const Span& span : line.spans) used += columns_of(span.text);
    EXPECT_EQ(used, size.columns) << text_of(line);
  }
  return text_of(frame);
}

}  // namespace fieldcast::cli
