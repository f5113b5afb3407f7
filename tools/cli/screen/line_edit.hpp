#pragma once

#include <string>

#include "tools/cli/text/frame.hpp"

namespace fieldcast::cli {

class LineEdit {
 public:
  static constexpr std::size_t kMostBytes = 256;  // further text is ignored

  // Returns true if the key edits the text.
  bool on_key(const Key& key) {
    if (key.kind == Key::Kind::kText) {
      if (text_.size() + key.text.size() <= kMostBytes) text_ += key.text;
      return true;
    }
    if (key.kind == Key::Kind::kClear) text_.clear();
    if (key.kind == Key::Kind::kBackspace) {
      while (!text_.empty() && (static_cast<unsigned char>(text_.back()) & 0xC0) == 0x80)
        text_.pop_back();
      if (!text_.empty()) text_.pop_back();
    }
    return key.kind == Key::Kind::kClear || key.kind == Key::Kind::kBackspace;
  }
  [[nodiscard]] const std::string& text() const { return text_; }
  void clear() { text_.clear(); }

 private:
  std::string text_;
};

}  // namespace fieldcast::cli
