#pragma once

#include <string>

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

}  // namespace fieldcast::cli
