#include "tools/cli/screen/watch_pane.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "core/base/message_text.hpp"
#include "tools/cli/model/sample_text.hpp"
#include "tools/cli/screen/list_control.hpp"
#include "tools/cli/screen/status_rows.hpp"
#include "tools/cli/screen/watch_screen.hpp"
#include "tools/cli/text/cell_text.hpp"
#include "tools/cli/view/station_view.hpp"
#include "tools/cli/view/status/status_words.hpp"

namespace fieldcast::cli {

namespace {

// The columns of ChannelCells, and one more.
enum class Field : unsigned char { kName, kValue, kUnit, kQuality, kAge, kRefresh, kRate, kMark };

struct FieldColumn {
  Field field;
  std::string_view head;
  std::size_t width;  // 0 for kName: the remaining width
  Align align = Align::kLeft;
  std::optional<ChannelOrder> order{};
};

constexpr FieldColumn kName{Field::kName, "channel", 0, Align::kLeft, ChannelOrder::kName};
constexpr FieldColumn kQuality{Field::kQuality, "quality", 17, Align::kLeft,
                               ChannelOrder::kBadFirst};
constexpr FieldColumn kUnit{Field::kUnit, "unit", 6};
constexpr FieldColumn kAge{Field::kAge, "age", 8, Align::kRight, ChannelOrder::kAge};
constexpr FieldColumn kRefresh{Field::kRefresh, "refresh", 8, Align::kRight};
constexpr FieldColumn kRate{Field::kRate, "rate", 7, Align::kRight, ChannelOrder::kRate};

constexpr FieldColumn value_column(std::size_t width) {
  return {Field::kValue, "value", width, Align::kRight, ChannelOrder::kValue};
}

std::vector<FieldColumn> fields_for(std::size_t columns) {
  std::vector<FieldColumn> fields;
  if (columns < 44) {
    fields = {kName, value_column(columns < 30 ? 7 : 10), {Field::kMark, "q", 1}};
  } else if (columns < 60) {
    fields = {kName, value_column(11), kQuality};
  } else if (columns < 72) {
    fields = {kName, value_column(12), kQuality, kAge};
  } else if (columns < 94) {
    fields = {kName, value_column(12), kUnit, kQuality, kAge, kRefresh};
  } else {
    fields = {kName, value_column(14), kUnit, kQuality, kAge, kRefresh, kRate};
  }
  std::size_t used = fields.size() - 1;
  for (const FieldColumn& one : fields) used += one.width;
  fields.front().width = columns - std::min(columns, used);
  return fields;
}

std::string_view mark_of(const WatchModel::Row& row) {
  switch (rank_of(row)) {
    case Rank::kBad: return "B";
    case Rank::kUncertain: return "U";
    case Rank::kUnread: return "-";
    case Rank::kGood: return "G";
  }
  return "?";
}

Span cell_of(const FieldColumn& column, const ChannelEntry& entry, const ChannelCells& cells,
             bool grouped, std::size_t columns) {
  const auto& [path, row] = entry;
  if (column.field == Field::kName && grouped)
    return {std::string(columns < 44 ? 2 : 4, ' ') + path.channel};
  if (column.field == Field::kMark)
    return {std::string(mark_of(row)), row.gone ? Tone::kBad : tone_of(row.sample.quality)};
  const Cell& cell = cells[static_cast<std::size_t>(column.field)];
  return {cell.text, cell.tone};
}

}  // namespace

FrameLine channel_heads(std::size_t columns) {
  std::vector<Span> spans;
  for (const FieldColumn& one : fields_for(columns)) {
    if (!spans.empty()) spans.push_back({" "});
    spans.push_back({fitted(one.head, one.width, one.align)});
  }
  return full_line(std::move(spans), columns, true);
}

FrameLine channel_line(const ListRow& row, const StationChannel* about, bool grouped,
                       const Moment& moment, std::size_t columns) {
  const ChannelEntry& entry = entry_of(row);
  const ChannelCells cells = channel_cells(entry.first, entry.second, about, moment);
  std::vector<Span> spans;
  for (const FieldColumn& one : fields_for(columns)) {
    if (!spans.empty()) spans.push_back({" "});
    Span cell = cell_of(one, entry, cells, grouped, columns);
    cell.text = fitted(shown(cell.text), one.width, one.align);
    spans.push_back(std::move(cell));
  }
  return full_line(std::move(spans), columns);
}

std::optional<ChannelOrder> order_at(std::size_t column, std::size_t columns) {
  std::size_t end = 0;
  for (const FieldColumn& one : fields_for(columns)) {
    end += one.width + 1;
    if (column < end) return one.order;
  }
  return std::nullopt;
}

namespace {

std::string value_with_unit(const Value& value, const std::string& type, const std::string& unit) {
  return shown(value_text(value, type) + (unit.empty() ? "" : ' ' + unit));
}

std::string present_value(const ChannelEntry* entry, const std::string& type,
                          const std::string& unit, UtcTime now) {
  if (entry == nullptr || entry->second.sample.acquired_at.nanoseconds == 0)
    return "not known: no value came yet";
  const StationSample& sample = entry->second.sample;
  return fmt::format("{}  ({}, {} old)", value_with_unit(sample.value, type, unit),
                     to_text(sample.quality), age_text(sample.acquired_at, now));
}

std::string number(double value) { return fmt::format("{:.6g}", value); }

std::string limits_text(const StationChannel& about) {
  std::string text;
  const auto add = [&](const char* name, const std::optional<double>& limit) {
    if (limit) text += fmt::format("{}{} {}", text.empty() ? "" : ", ", name, number(*limit));
  };
  add("low-low", about.limits.low_low);
  add("low", about.limits.low);
  add("high", about.limits.high);
  add("high-high", about.limits.high_high);
  add("least to write", about.write_min);
  add("most to write", about.write_max);
  return text.empty() ? text : "; limits: " + text;
}

FrameLine text_line(std::string text, Tone tone = Tone::kPlain) {
  return {{{std::move(text), tone}}, false};
}

std::string trend_head(const TrendPoints& points, std::size_t shown_points) {
  const auto& from = points[points.size() - shown_points].at;
  return fmt::format("last {} values, {}", shown_points, age_text(from, points.back().at));
}

std::string trend_line(const TrendPoints& points, std::size_t columns, bool unicode) {
  const std::size_t count = std::min(points.size(), columns > 50 ? columns - 50 : columns / 2);
  if (count < 2) return "the trend begins here: a value that changes gets a line";
  const auto [least, most] =
      std::minmax_element(points.end() - static_cast<std::ptrdiff_t>(count), points.end(),
                          [](const auto& a, const auto& b) { return a.value < b.value; });
  return fmt::format("{} [{}] {}  {}", number(least->value), sparkline(points, count, unicode),
                     number(most->value), trend_head(points, count));
}

}  // namespace

// Truncates the beginning, because the user types at the end.
std::string WatchScreen::input_text() const {
  std::string text = shown(typed_.text());
  const std::string before = columns_ < 44 ? "new " : "new value   ";
  while (!text.empty() && columns_of(before) + columns_of(text) >= columns_)
    text.erase(0, std::max<std::size_t>(1, utf8_length(text)));
  return before + text;
}

std::vector<FrameLine> WatchScreen::question_lines(const Moment& moment, std::size_t columns) {
  const auto found = model_.rows().find(write_.path);
  const ChannelEntry* entry = found == model_.rows().end() ? nullptr : &*found;
  const StationChannel* about = model_.catalogue().find(write_.path);
  std::vector<FrameLine> lines;
  const auto add = [&](const std::string& text, Tone tone = Tone::kPlain) {
    for (auto& line : wrapped(text, columns, 2)) lines.push_back(text_line(std::move(line), tone));
  };
  add("Write " + shown(write_.path.text()), Tone::kTitle);
  for (FrameLine& line : lines) line = full_line(std::move(line.spans), columns, true);
  add("value now   " + present_value(entry, write_.type, write_.unit, moment.utc));
  input_line_ = lines.size();
  if (question_ == Question::kValue) {
    lines.push_back(text_line(input_text(), Tone::kTitle));
    if (fault_.empty())
      add(shown(write_.type + (about != nullptr ? limits_text(*about) : "")), Tone::kFaint);
    else
      add(shown(fault_), Tone::kBad);
    add("Enter: go on   Esc: leave it", Tone::kFaint);
  } else {
    add("new value   " + value_with_unit(write_.value, write_.type, write_.unit), Tone::kWarning);
    add("y: write it   v: write it and read it back   n or Esc: leave it", Tone::kTitle);
  }
  return lines;
}

std::vector<FrameLine> WatchScreen::channel_details(const ListRow& row, const Moment& moment,
                                                    std::size_t columns) const {
  const auto& [path, state] = entry_of(row);
  const StationSample& sample = state.sample;
  const StationChannel* about = model_.catalogue().find(path);
  const std::string type = about != nullptr ? about->type : "";
  const std::string unit = about != nullptr ? about->unit : "";
  std::vector<FrameLine> lines;
  lines.push_back(full_line({{shown(path.text()), Tone::kTitle}}, columns, true));
  lines.push_back(
      {{{present_value(&entry_of(row), type, unit, moment.utc)},
        {about != nullptr && !about->description.empty() ? "  " + shown(about->description) : "",
         Tone::kFaint}},
       false});
  if (state.gone) {
    lines.push_back(text_line("GONE: its bridge ended, or no longer has this channel", Tone::kBad));
  } else {
    const auto words = wrapped(
        shown(fmt::format("{}: {}", quality_text(sample, about), quality_words(sample.quality))),
        columns, 2);
    for (const auto& line : words) lines.push_back(text_line(line, tone_of(sample.quality)));
  }
  if (about != nullptr) {
    const std::string facts = shown(fmt::format(
        "{} at {}, {}, refresh {}; acquired {}; bridge {}{}", about->type, about->at,
        to_text(about->access),
        about->refresh == Duration{} ? std::string("none promised") : to_text(about->refresh),
        utc_text(sample.acquired_at), about->bridge, limits_text(*about)));
    for (const auto& line : wrapped(facts, columns, 2))
      lines.push_back(text_line(line, Tone::kFaint));
  }
  if (const TrendPoints* points = trends_.find(path); points != nullptr && !points->empty())
    lines.push_back(text_line(trend_line(*points, columns, unicode_)));
  return lines;
}

std::vector<FrameLine> WatchScreen::pane(const Moment& moment, std::size_t columns) const {
  const ListRow* row = control_.list.selected();
  if (row == nullptr) return {};
  if (row->is_channel()) return channel_details(*row, moment, columns);
  return status_details(status_, row->id, moment.utc, columns);
}

}  // namespace fieldcast::cli
