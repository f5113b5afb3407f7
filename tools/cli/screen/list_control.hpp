// Common part of all list screens: keys to move, fold, filter and show help, and the layout. Pure
// values.
#pragma once

#include <cstddef>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "tools/cli/screen/frame.hpp"
#include "tools/cli/screen/line_edit.hpp"
#include "tools/cli/screen/row_list.hpp"

namespace fieldcast::cli {

// Rows of each part; 0: hidden. On a small screen the list has priority, then the bottom line, the
// title, the heads, the pane and the state.
struct Layout {
  std::size_t columns = 80;
  std::size_t title = 0, state = 0, head = 0;  // 0 or 1
  std::size_t list_top = 0, list_rows = 0;
  std::size_t pane = 0;
  std::size_t bottom = 0;  // 0 or 1
};
// `pane`: requested rows below the list. `must`: a question that the user must see.
[[nodiscard]] Layout layout_of(const Screen& screen, std::size_t pane, bool must = false);

// A key in the bottom line; a click on it has the same effect.
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

class ListControl {
 public:
  enum class Mode : unsigned char { kList, kFilter, kHelp };
  enum class Took : unsigned char {
    kNothing,  // not a key of lists
    kKey,
    kQuit,
  };

  [[nodiscard]] Took on_key(const Key& key);
  // Returns the clicked key of the bottom line; empty for another place.
  [[nodiscard]] std::optional<Key> bar_key(const Key& click) const;
  // Returns the clicked column of the heads; empty for another place.
  [[nodiscard]] std::optional<std::size_t> head_click(const Key& key) const;

  // Draws the parts and stores their positions for clicks and pages.
  [[nodiscard]] Frame compose(const Layout& layout, const ScreenParts& parts);

  RowList list;
  Mode mode = Mode::kList;
  LineEdit filter;
  bool details = true;  // the pane is enabled
  bool stale = true;    // rows must be rebuilt: a filter or fold has changed

 private:
  Took on_filter_key(const Key& key);
  Took on_help_key(const Key& key);
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

// Fills the columns exactly; truncates the rest.
[[nodiscard]] FrameLine full_line(std::vector<Span> spans, std::size_t columns,
                                  bool inverse = false);
// Joins as many pieces as fit with two spaces; truncates the first one if necessary.
[[nodiscard]] std::string fitting_pieces(std::span<const std::string> pieces, std::size_t columns);

}  // namespace fieldcast::cli
