#include "tools/cli/screen/watch_screen.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <utility>

#include "tools/cli/model/sample_text.hpp"
#include "tools/cli/screen/status_rows.hpp"
#include "tools/cli/screen/watch_pane.hpp"
#include "tools/cli/text/cell_text.hpp"

namespace fieldcast::cli {
namespace {

const std::array kWatchBar{
    BarKey{"F1", "help", function_key(1)}, BarKey{"/", "filter", text_key("/")},
    BarKey{"s", "sort", text_key("s")},    BarKey{"w", "write", text_key("w")},
    BarKey{"t", "groups", text_key("t")},  BarKey{"b", "bad only", text_key("b")},
    BarKey{"d", "details", text_key("d")}, BarKey{"q", "quit", text_key("q")},
};

constexpr std::array<std::string_view, 22> kWatchHelp{
    "",
    " Up Down PgUp PgDn Home End   move (j and k too; the wheel scrolls)",
    " Enter, Space, Left, Right    fold and unfold a bus or a device (or click it)",
    " /  F3 F4    filter: words that path, unit or quality must have; Esc clears it",
    " s  F6       sort: bad first, name, value, age, rate (or click a head)",
    " i           the other way round",
    " t  F5       groups of buses and devices, or one list of channels",
    " b           only what is not GOOD",
    " w  F7       write a value to the selected channel; asks before it does",
    " d           details of the selected row, or more rows",
    " Ctrl-L      draw the screen again",
    " q  F10      quit (Ctrl-C too)",
    "",
    " GOOD             the device gave this value, and its refresh is kept",
    " UNCERTAIN        good once, old now; nothing is known to be broken",
    " BAD_NO_ANSWER    the device, or the way to it, is silent",
    " BAD_FRAME        bytes arrive that are not a valid response",
    " BAD_DEVICE_ERROR the device reports that it cannot",
    " BAD_RANGE        the bytes are no value of the type",
    " BAD_CONFIGURATION  the channel cannot be read as it is configured",
    " NOT_YET_READ     there was no value since the bridge started",
    " GONE             its bridge ended, or no longer has the channel",
};

}  // namespace

void WatchScreen::on_sample(const StationSample& sample) {
  if (sample.acquired_at.nanoseconds != 0 && sample.quality == Quality::kGood)
    trends_.add({sample.bus, sample.device, sample.channel}, sample.value, sample.acquired_at);
}

void WatchScreen::rebuild(const Moment& moment) {
  choice_.filter = control_.filter.text();
  sums_ = channel_rows(model_, choice_, control_.list, moment.now);
  control_.list.assign(std::exchange(sums_.rows, {}));
  control_.stale = false;
  sorted_at_ = moment.now;
}

Intent WatchScreen::on_key(const Key& given, const Moment& moment) {
  if (given.kind == Key::Kind::kRedraw) return {};
  if (question_ != Question::kNone) return on_question_key(given);
  message_ = {};
  const Key key = control_.bar_key(given).value_or(given);
  const auto took = control_.mode == ListControl::Mode::kList && on_own_key(key)
                        ? ListControl::Took::kKey
                        : control_.on_key(key);
  if (control_.stale) rebuild(moment);
  return took == ListControl::Took::kQuit ? Intent(QuitIntent{}) : Intent{};
}

bool WatchScreen::on_own_key(const Key& key) {
  const auto is = [&](const char* letter, int function) { return is_key(key, letter, function); };
  if (const auto column = control_.head_click(key)) {
    const auto order = order_at(*column, columns_);
    if (!order) return false;
    choice_.inverted = *order == choice_.order && !choice_.inverted;
    choice_.order = *order;
  } else if (is("s", 6)) {
    constexpr auto kOrders = static_cast<unsigned>(ChannelOrder::kCount);
    choice_.order = static_cast<ChannelOrder>((static_cast<unsigned>(choice_.order) + 1) % kOrders);
    choice_.inverted = false;
  } else if (is("i", -1)) {
    choice_.inverted = !choice_.inverted;
  } else if (is("t", 5)) {
    choice_.grouped = !choice_.grouped;
  } else if (is("b", -1)) {
    choice_.bad_only = !choice_.bad_only;
  } else if (is("w", 7)) {
    ask_for_value();
    return true;
  } else {
    return false;
  }
  control_.stale = true;
  return true;
}

void WatchScreen::ask_for_value() {
  const ListRow* row = control_.list.selected();
  if (waiting_) {
    message_ = {"the write before has no result yet", Tone::kWarning};
    return;
  }
  if (row == nullptr || !row->is_channel()) {
    message_ = {"select a channel to write to", Tone::kWarning};
    return;
  }
  const StationChannel* about = model_.catalogue().find(row->id);
  if (about == nullptr) {
    message_ = {"no bridge has announced this channel", Tone::kWarning};
    return;
  }
  if (about->access == Access::kReadOnly) {
    message_ = {
        shown(row->id.text()) + " is read-only (access: read-write would let it be written)",
        Tone::kWarning};
    return;
  }
  write_ = {row->id, {}, about->type, about->unit, false};
  typed_.clear();
  fault_.clear();
  question_ = Question::kValue;
}

Intent WatchScreen::on_question_key(const Key& key) {
  const bool confirm = question_ == Question::kConfirm;
  if (key.kind == Key::Kind::kEscape ||
      (confirm && key.kind == Key::Kind::kText && (key.text == "n" || key.text == "N"))) {
    question_ = Question::kNone;
    message_ = {"nothing was written", Tone::kPlain};
  } else if (!confirm) {
    if (key.kind == Key::Kind::kEnter)
      take_value();
    else if (typed_.on_key(key))
      fault_.clear();
  } else if (key.kind == Key::Kind::kText &&
             (key.text == "y" || key.text == "Y" || key.text == "v" || key.text == "V")) {
    question_ = Question::kNone;
    waiting_ = true;
    write_.verify = key.text == "v" || key.text == "V";
    message_ = {fmt::format("writing {} ..", shown(write_.path.text())), Tone::kPlain};
    return write_;
  }
  return {};
}

void WatchScreen::take_value() {
  const auto encoding = parse_type(write_.type);
  if (!encoding) {
    fault_ = encoding.error();
    return;
  }
  const auto value = value_from_text(*encoding, typed_.text());
  if (!value) {
    fault_ = value.error().text;
    return;
  }
  write_.value = *value;
  question_ = Question::kConfirm;
}

void WatchScreen::on_outcome(const Outcome& outcome) {
  waiting_ = false;
  message_ = {shown(outcome_line(outcome)),
              exit_code_of(outcome) == ExitCode::kOk ? Tone::kGood : Tone::kBad};
}

FrameLine WatchScreen::title(const Moment& moment, std::size_t columns) const {
  const double rate = model_.rate(moment.now);
  const std::array pieces{
      std::string(columns < 44 ? "watch" : "fieldcast watch"),
      sums_.bad == 0 ? std::string{} : fmt::format("{} BAD", sums_.bad),
      fmt::format("{} of {} GOOD", sums_.good, sums_.channels),
      rate < 10 ? fmt::format("{:.1f} samples/s", rate) : fmt::format("{:.0f} samples/s", rate),
      shown(model_.pattern().text()),
  };
  return title_line({fitting_pieces(pieces, columns), sums_.bad == 0 ? Tone::kTitle : Tone::kBad},
                    clock_text(moment.utc), columns);
}

FrameLine WatchScreen::state_line(std::size_t list_rows, std::size_t columns) {
  const std::size_t rows = control_.list.rows().size();
  const std::size_t top = control_.list.top(list_rows);
  const std::array pieces{
      rows == 0 ? std::string("no rows")
                : fmt::format("rows {}-{} of {}", top + 1, std::min(rows, top + list_rows), rows),
      fmt::format("sort: {}{}", order_text(choice_.order), choice_.inverted ? ", inverted" : ""),
      std::string(choice_.bad_only ? "only what is not GOOD" : ""),
      choice_.filter.empty()
          ? std::string{}
          : fmt::format("filter: {}, {} match", shown(choice_.filter), sums_.matching),
  };
  std::string text = fitting_pieces(pieces, columns);
  if (remark_.empty()) return full_line({{std::move(text), Tone::kFaint}}, columns);
  return full_line({{fitted(shown(remark_), columns), Tone::kWarning}}, columns);
}

FrameLine WatchScreen::group_line(const ListRow& row, std::size_t columns) const {
  const std::string before = std::string(row.is_bus() ? 0 : columns < 44 ? 1 : 2, ' ');
  std::string text =
      before + (row.folded ? "+ " : "- ") + shown(row.is_bus() ? row.id.bus : row.id.device);
  std::vector<Span> spans{{std::move(text), Tone::kTitle}};
  spans.push_back({columns < 44 ? fmt::format(" {}/{}", row.good, row.members)
                                : fmt::format("  {} of {} GOOD", row.good, row.members),
                   row.good == row.members ? Tone::kFaint : Tone::kPlain});
  if (row.bad != 0)
    spans.push_back({columns < 44 ? fmt::format(" {}B", row.bad) : fmt::format(", {} BAD", row.bad),
                     Tone::kBad});
  if (const auto state = group_state(status_, row.id); !state.text.empty())
    spans.push_back({"  " + state.text, state.tone});
  return full_line(std::move(spans), columns);
}

Frame WatchScreen::frame(const Moment& moment, const Screen& screen) {
  columns_ = screen.columns;
  if (control_.stale || !sorted_at_ || moment.now - *sorted_at_ >= kSortAgain ||
      sums_.channels != model_.rows().size())
    rebuild(moment);
  if (const ListRow* row = control_.list.selected(); row != nullptr && row->is_channel()) {
    trends_.follow(row->id);
    on_sample(entry_of(*row).second.sample);
  }
  const bool asking = question_ != Question::kNone;
  const bool wide_message = columns_of(message_.text) > screen.columns;
  std::vector<FrameLine> below;
  if (asking) {
    below = question_lines(moment, screen.columns);
  } else if (wide_message) {
    for (auto& line : wrapped(message_.text, screen.columns))
      below.push_back({{{std::move(line), message_.tone}}, false});
  } else if (control_.details) {
    below = pane(moment, screen.columns);
  }
  const Layout layout = layout_of(screen, below.size(), asking || wide_message);
  ScreenParts parts;
  parts.title = title(moment, screen.columns);
  parts.state = state_line(layout.list_rows, screen.columns);
  parts.head = channel_heads(screen.columns);
  parts.row = [&](const ListRow& row, std::size_t columns) {
    return row.is_channel() ? channel_line(row, model_.catalogue().find(row.id), choice_.grouped,
                                           moment, columns)
                            : group_line(row, columns);
  };
  parts.pane = std::move(below);
  parts.notice = sums_.channels == 0      ? shown(notice_)
                 : sums_.matching != 0    ? std::string{}
                 : choice_.filter.empty() ? std::string("everything is GOOD (b shows all)")
                                          : std::string("nothing matches the filter (Esc)");
  parts.bar = kWatchBar;
  parts.message = asking || wide_message ? Span{} : message_;
  parts.help = kWatchHelp;
  Frame frame = control_.compose(layout, parts);
  if (question_ == Question::kValue && layout.pane > input_line_)
    frame.cursor = {layout.list_top + layout.list_rows + input_line_,
                    std::min(screen.columns - 1, columns_of(input_text()))};
  return frame;
}

}  // namespace fieldcast::cli
