#include "tools/cli/screen/list_control.hpp"

#include <algorithm>

#include "tools/cli/text/cell_text.hpp"

namespace fieldcast::cli {

namespace {

constexpr std::ptrdiff_t kWheelRows = 3;

}  // namespace

Layout layout_of(const Screen& screen, std::size_t pane, bool must) {
  Layout layout;
  layout.columns = screen.columns;
  const std::size_t rows = screen.rows;
  if (must && rows < pane + 6) {  // shows only the question
    layout.pane = std::min(pane, rows);
    layout.list_rows = rows - layout.pane;
    return layout;
  }
  layout.bottom = rows >= 2 ? 1 : 0;
  layout.title = rows >= 4 ? 1 : 0;
  layout.head = rows >= 5 ? 1 : 0;
  layout.state = rows >= 12 ? 1 : 0;
  const std::size_t fixed = layout.bottom + layout.title + layout.head + layout.state;
  const std::size_t left = rows - std::min(rows, fixed);
  // minimum height of the list
  const std::size_t list = must ? 1 : std::max<std::size_t>(6, left / 2);
  layout.pane = std::min(pane, left - std::min(left, list));
  if (!must && layout.pane < 2) layout.pane = 0;
  layout.list_top = layout.title + layout.state + layout.head;
  layout.list_rows = left - layout.pane;
  return layout;
}

FrameLine full_line(std::vector<Span> spans, std::size_t columns, bool inverse) {
  FrameLine line{{}, inverse};
  std::size_t used = 0;
  for (Span& span : spans) {
    if (used + columns_of(span.text) > columns) span.text = cut(span.text, columns - used);
    used += columns_of(span.text);
    if (!span.text.empty()) line.spans.push_back(std::move(span));
  }
  if (used < columns) line.spans.push_back({std::string(columns - used, ' ')});
  return line;
}

FrameLine title_line(Span title, const std::string& clock, std::size_t columns) {
  std::vector<Span> spans{std::move(title)};
  if (const std::size_t used = columns_of(spans.front().text) + clock.size(); used + 2 <= columns) {
    spans.push_back({std::string(columns - used, ' ')});
    spans.push_back({clock, Tone::kFaint});
  }
  return full_line(std::move(spans), columns);
}

std::string fitting_pieces(std::span<const std::string> pieces, std::size_t columns) {
  std::string line;
  for (const std::string& piece : pieces) {
    if (piece.empty()) continue;
    if (line.empty())
      line = cut(piece, columns);
    else if (columns_of(line) + 2 + columns_of(piece) <= columns)
      line += "  " + piece;
  }
  return line;
}

ListControl::Took ListControl::on_key(const Key& key) {
  if (key.kind == Key::Kind::kRedraw) return Took::kKey;
  if (mode == Mode::kHelp) return on_help_key(key);
  if (mode == Mode::kFilter) {
    if (const Took took = on_filter_key(key); took != Took::kNothing) return took;
  }
  return on_list_key(key);
}

ListControl::Took ListControl::on_list_key(const Key& key) {
  const auto page = static_cast<std::ptrdiff_t>(std::max<std::size_t>(2, layout_.list_rows) - 1);
  switch (key.kind) {
    case Key::Kind::kUp: move(-1); return Took::kKey;
    case Key::Kind::kDown: move(1); return Took::kKey;
    case Key::Kind::kPageUp: move(-page); return Took::kKey;
    case Key::Kind::kPageDown: move(page); return Took::kKey;
    case Key::Kind::kHome: list.select(0); return Took::kKey;
    case Key::Kind::kEnd: list.select(list.rows().size()); return Took::kKey;
    case Key::Kind::kLeft: fold_to_left(); return Took::kKey;
    case Key::Kind::kRight: unfold_to_right(); return Took::kKey;
    case Key::Kind::kEnter: toggle_fold(); return Took::kKey;
    case Key::Kind::kEscape:
      filter.clear();
      stale = true;
      return Took::kKey;
    case Key::Kind::kWheelUp: list.scroll(-kWheelRows, layout_.list_rows); return Took::kKey;
    case Key::Kind::kWheelDown: list.scroll(kWheelRows, layout_.list_rows); return Took::kKey;
    case Key::Kind::kClick: return on_click(key);
    case Key::Kind::kFunction:
      if (key.number == 1) mode = Mode::kHelp;
      if (key.number == 3 || key.number == 4) mode = Mode::kFilter;
      if (key.number == 10) return Took::kQuit;
      return key.number == 1 || key.number == 3 || key.number == 4 ? Took::kKey : Took::kNothing;
    case Key::Kind::kText: return on_letter(key.text);
    default: return Took::kNothing;
  }
}

ListControl::Took ListControl::on_letter(std::string_view letter) {
  struct Letter {
    std::string_view letter;
    Key::Kind kind;  // of the key that has the same effect
    int number = 0;  // of a function key
  };
  using Kind = Key::Kind;
  constexpr Letter kLetters[] = {
      {"q", Kind::kFunction, 10}, {"?", Kind::kFunction, 1}, {"h", Kind::kFunction, 1},
      {"/", Kind::kFunction, 3},  {"k", Kind::kUp},          {"j", Kind::kDown},
      {"g", Kind::kHome},         {"G", Kind::kEnd},         {" ", Kind::kEnter},
      {"-", Kind::kLeft},         {"+", Kind::kRight},
  };
  if (letter == "d") {
    details = !details;
    return Took::kKey;
  }
  const auto* same = std::ranges::find(kLetters, letter, &Letter::letter);
  if (same == std::end(kLetters)) return Took::kNothing;
  return on_list_key({.kind = same->kind, .number = same->number});
}

ListControl::Took ListControl::on_filter_key(const Key& key) {
  if (key.kind == Key::Kind::kEnter || key.kind == Key::Kind::kEscape) {
    if (key.kind == Key::Kind::kEscape) filter.clear();
    mode = Mode::kList;
    stale = true;
    return Took::kKey;
  }
  if (!filter.on_key(key)) return Took::kNothing;
  stale = true;
  return Took::kKey;
}

ListControl::Took ListControl::on_help_key(const Key& key) {
  if (key.kind == Key::Kind::kDown || key.kind == Key::Kind::kWheelDown ||
      key.kind == Key::Kind::kPageDown) {
    help_top_ += key.kind == Key::Kind::kDown ? 1 : 5;
  } else if (key.kind == Key::Kind::kUp || key.kind == Key::Kind::kWheelUp ||
             key.kind == Key::Kind::kPageUp) {
    help_top_ -= std::min<std::size_t>(help_top_, key.kind == Key::Kind::kUp ? 1 : 5);
  } else {
    mode = Mode::kList;
    help_top_ = 0;
  }
  return Took::kKey;
}

ListControl::Took ListControl::on_click(const Key& key) {
  const std::size_t list_end = layout_.list_top + layout_.list_rows;
  if (key.row >= layout_.list_top && key.row < list_end) {
    const std::size_t index = list.top(layout_.list_rows) + key.row - layout_.list_top;
    if (index >= list.rows().size()) return Took::kKey;
    if (index == list.index())
      toggle_fold();
    else
      list.select(index);
    return Took::kKey;
  }
  return Took::kNothing;
}

std::optional<Key> ListControl::bar_key(const Key& click) const {
  if (click.kind != Key::Kind::kClick) return std::nullopt;
  if (click.row < layout_.list_top + layout_.list_rows + layout_.pane) return std::nullopt;
  for (const BarPlace& place : bar_) {
    if (click.column >= place.from && click.column < place.to) return place.key;
  }
  return std::nullopt;
}

std::optional<std::size_t> ListControl::head_click(const Key& key) const {
  if (key.kind != Key::Kind::kClick || mode != Mode::kList || layout_.head == 0 ||
      key.row + 1 != layout_.list_top)
    return std::nullopt;
  return key.column;
}

void ListControl::toggle_fold() {
  const ListRow* row = list.selected();
  if (row == nullptr || !row->is_group()) return;
  list.fold(row->id, !row->folded);
  stale = true;
}

// Folds the group. For a member or a folded group, selects its parent group.
void ListControl::fold_to_left() {
  const ListRow* row = list.selected();
  if (row == nullptr) return;
  if (row->is_group() && !row->folded) return toggle_fold();
  ChannelPath parent = row->id;
  (row->is_channel() ? parent.channel : parent.device).clear();
  const auto found = std::ranges::find(list.rows(), parent, &ListRow::id);
  if (found != list.rows().end())
    list.select(static_cast<std::size_t>(found - list.rows().begin()));
}

void ListControl::unfold_to_right() {
  const ListRow* row = list.selected();
  if (row == nullptr || !row->is_group()) return;
  if (row->folded)
    toggle_fold();
  else
    move(1);
}

FrameLine ListControl::bottom_line(const ScreenParts& parts, std::size_t columns) {
  bar_.clear();
  if (mode == Mode::kHelp) return full_line({{"any other key: back", Tone::kFaint}}, columns);
  if (!parts.message.text.empty())
    return full_line({{fitted(parts.message.text, columns), parts.message.tone}}, columns);
  std::vector<Span> spans;
  std::size_t used = 0;
  for (const BarKey& one : parts.bar) {
    const std::size_t wide = one.label.size() + one.words.size() + 2;
    if (used + wide > columns) break;
    spans.push_back({std::string(one.label), Tone::kTitle});
    spans.push_back({' ' + std::string(one.words) + ' ', Tone::kFaint});
    bar_.push_back({used, used + wide - 1, one.key});
    used += wide;
  }
  return full_line(std::move(spans), columns);
}

Frame ListControl::compose(const Layout& layout, const ScreenParts& parts) {
  layout_ = layout;
  Frame frame;
  const std::size_t columns = layout.columns;
  const auto add = [&](std::size_t rows, FrameLine line) {
    if (rows != 0) frame.lines.push_back(full_line(std::move(line.spans), columns, line.inverse));
  };
  add(layout.title, parts.title);
  add(layout.state, parts.state);
  add(layout.head, parts.head);
  if (mode == Mode::kHelp) {
    std::vector<std::string> help;
    for (const std::string_view text : parts.help) {
      for (std::string& line : wrapped(text, columns, 2)) help.push_back(std::move(line));
    }
    const std::size_t rows = layout.list_rows + layout.pane;
    help_top_ = std::min(help_top_, help.size() > rows ? help.size() - rows : 0);
    for (std::size_t i = help_top_; i < help_top_ + rows; ++i)
      add(1, {{{i < help.size() ? help[i] : std::string{}}}});
  } else {
    const std::size_t top = list.top(layout.list_rows);
    for (std::size_t i = 0; i < layout.list_rows; ++i) {
      if (list.rows().empty() && i == layout.list_rows / 3) {
        add(1, {{{parts.notice, Tone::kWarning}}});
      } else if (top + i >= list.rows().size()) {
        add(1, {});
      } else {
        FrameLine line = parts.row(list.rows()[top + i], columns);
        line.inverse = top + i == list.index();
        add(1, std::move(line));
      }
    }
    for (std::size_t i = 0; i < layout.pane; ++i)
      add(1, i < parts.pane.size() ? parts.pane[i] : FrameLine{});
  }
  if (layout.bottom != 0) {
    if (mode == Mode::kFilter) {
      const std::string prompt = "filter: " + shown(filter.text());
      const std::string line =
          columns_of(prompt) < columns ? prompt : cut("/" + shown(filter.text()), columns - 1);
      bar_.clear();
      frame.cursor = {frame.lines.size(), columns_of(line)};
      add(1, {{{line, Tone::kTitle}}});
    } else {
      frame.lines.push_back(bottom_line(parts, columns));
    }
  }
  return frame;
}

}  // namespace fieldcast::cli
