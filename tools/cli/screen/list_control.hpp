// What every screen with a list has: the keys that move, fold, filter and explain, and where on the
// screen its parts stand. Pure values.
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

// Rows of the terminal that each part takes. A part of no rows is left out: on a small screen the
// list comes first, then the bottom line, then the title, the heads, the pane and the state.
struct Layout {
  std::size_t columns = 80;
  std::size_t title = 0, state = 0, head = 0;  // one row or none
  std::size_t list_top = 0, list_rows = 0;
  std::size_t pane = 0;
  std::size_t bottom = 0;  // one row or none
};
// `pane`: rows that are wanted below the list. `must`: a question that a person has to see.
[[nodiscard]] Layout layout_of(const Screen& screen, std::size_t pane, bool must = false);

// What the bottom line offers; a click on it is the key.
struct BarKey {
  std::string_view label;  // "F1"
  std::string_view words;  // "help"
  Key key;
};

struct ScreenParts {
  FrameLine title, state, head;
  std::function<FrameLine(const ListRow&, std::size_t columns)> row;
  std::vector<FrameLine> pane;
  std::string notice;           // in place of rows, while there are none
  std::span<const BarKey> bar;  // shown when there is no message
  Span message;                 // in the bottom line; empty: none
  std::span<const std::string_view> help;
};

class ListControl {
 public:
  enum class Mode : unsigned char { kList, kFilter, kHelp };
  enum class Took : unsigned char {
    kNothing,  // the key means nothing to lists
    kKey,
    kQuit,
  };

  [[nodiscard]] Took on_key(const Key& key);
  // The key of the bottom line that was clicked. Nothing: the click was elsewhere.
  [[nodiscard]] std::optional<Key> bar_key(const Key& click) const;
  // The column of a click on the heads. Nothing: it was elsewhere.
  [[nodiscard]] std::optional<std::size_t> head_click(const Key& key) const;

  // Draws the parts; remembers where they are, for clicks and pages.
  [[nodiscard]] Frame compose(const Layout& layout, const ScreenParts& parts);

  RowList list;
  Mode mode = Mode::kList;
  LineEdit filter;
  bool details = true;  // the pane is wanted
  bool stale = true;    // the rows are to be made anew: a filter or a fold has changed

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

// Spans that fill the columns exactly; what does not fit is cut.
[[nodiscard]] FrameLine full_line(std::vector<Span> spans, std::size_t columns,
                                  bool inverse = false);
// As many of the pieces as fit, two spaces between them; the first one is cut if it must be.
[[nodiscard]] std::string fitting_pieces(std::span<const std::string> pieces, std::size_t columns);

}  // namespace fieldcast::cli
