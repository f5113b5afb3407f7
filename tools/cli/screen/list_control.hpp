#pragma once

#include <cstddef>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "tools/cli/screen/row_list.hpp"
#include "tools/cli/text/output.hpp"

namespace fieldcast::cli {

class LineEdit {
 public:
  static constexpr std::size_t kMostBytes = 256;  // further text is ignored

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

// Rows of each part; 0: hidden. Priority on a small screen: list, bottom line, title, heads, pane,
// state.
struct Layout {
  std::size_t columns = 80;
  std::size_t title = 0, state = 0, head = 0;  // 0 or 1
  std::size_t list_top = 0, list_rows = 0;
  std::size_t pane = 0;
  std::size_t bottom = 0;  // 0 or 1
};
// `pane`: requested rows below the list. `must`: a question that the user must see.
[[nodiscard]] Layout layout_of(const Screen& screen, std::size_t pane, bool must = false);

struct BarKey {
  std::string_view label;  // "F1"
  std::string_view words;  // "help"
  Key key;
};

struct ScreenParts {
  FrameLine title, state, head;
  std::function<FrameLine(const ListRow&, std::size_t columns)> row;
  std::vector<FrameLine> pane;
  std::string notice;           // shown if there are no rows
  std::span<const BarKey> bar;  // shown if there is no message
  Span message;                 // in the bottom line; empty: none
  std::span<const std::string_view> help;
};

// Keys and layout that all list screens share. Pure values.
class ListControl {
 public:
  enum class Mode : unsigned char { kList, kFilter, kHelp };
  enum class Took : unsigned char {
    kNothing,  // not a key of lists
    kKey,
    kQuit,
  };

  [[nodiscard]] Took on_key(const Key& key);
  [[nodiscard]] std::optional<Key> bar_key(const Key& click) const;
  [[nodiscard]] std::optional<std::size_t> head_click(const Key& key) const;

  // Stores the positions of the parts for clicks and pages.
  [[nodiscard]] Frame compose(const Layout& layout, const ScreenParts& parts);

  RowList list;
  Mode mode = Mode::kList;
  LineEdit filter;
  bool details = true;  // the pane is enabled
  bool stale = true;    // rows must be rebuilt: a filter or fold has changed

 private:
  Took on_filter_key(const Key& key);
  Took on_help_key(const Key& key);
  Took on_list_key(const Key& key);
  Took on_letter(std::string_view letter);
  Took on_click(const Key& key);
  void move(std::ptrdiff_t by) { list.move(by); }
  void toggle_fold();
  void fold_to_left();
  void unfold_to_right();
  [[nodiscard]] FrameLine bottom_line(const ScreenParts& parts, std::size_t columns);

  Layout layout_;
  std::size_t help_top_ = 0;
  struct BarPlace {
    std::size_t from, to;
    Key key;
  };
  std::vector<BarPlace> bar_;
};

// The letter, or the function key of this number (-1: none).
[[nodiscard]] inline bool is_key(const Key& key, std::string_view letter, int function) {
  return (key.kind == Key::Kind::kText && key.text == letter) ||
         (key.kind == Key::Kind::kFunction && key.number == function);
}

[[nodiscard]] FrameLine full_line(std::vector<Span> spans, std::size_t columns,
                                  bool inverse = false);
// Joins as many pieces as fit; truncates the first one if necessary.
[[nodiscard]] std::string fitting_pieces(std::span<const std::string> pieces, std::size_t columns);

// The clock, "12:34:56Z", is at the right if it fits.
[[nodiscard]] FrameLine title_line(Span title, const std::string& clock, std::size_t columns);

}  // namespace fieldcast::cli
