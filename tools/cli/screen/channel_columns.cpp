#include "tools/cli/screen/channel_columns.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "tools/cli/model/sample_text.hpp"
#include "tools/cli/screen/list_control.hpp"
#include "tools/cli/text/cell_text.hpp"

namespace fieldcast::cli {
namespace {

enum class Field : unsigned char { kName, kValue, kUnit, kQuality, kMark, kAge, kRefresh, kRate };

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

// Warns above twice the refresh, because the bridge itself may have stopped.
Tone tone_of_age(const StationSample& sample, const StationChannel* about, UtcTime now) {
  if (about == nullptr || about->refresh == Duration{} || sample.acquired_at.nanoseconds == 0)
    return Tone::kFaint;
  return now.nanoseconds - sample.acquired_at.nanoseconds > 2 * about->refresh.count()
             ? Tone::kWarning
             : Tone::kPlain;
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

std::string rate_cell(double rate) {
  return rate < 10 ? fmt::format("{:.1f}/s", rate) : fmt::format("{:.0f}/s", rate);
}

Span cell_of(const FieldColumn& column, const ChannelEntry& entry, const StationChannel* about,
             bool grouped, const Moment& moment, std::size_t columns) {
  const auto& [path, row] = entry;
  const StationSample& sample = row.sample;
  switch (column.field) {
    case Field::kName:
      return {grouped ? std::string(columns < 44 ? 2 : 4, ' ') + path.channel : path.text()};
    case Field::kValue:
      return {sample.acquired_at.nanoseconds == 0
                  ? "-"
                  : value_text(sample.value, about != nullptr ? about->type : std::string{}),
              Tone::kTitle};
    case Field::kUnit: return {about != nullptr ? about->unit : ""};
    case Field::kQuality:
      return row.gone ? Span{"GONE", Tone::kBad}
                      : Span{quality_text(sample, about), tone_of(sample.quality)};
    case Field::kMark:
      return {std::string(mark_of(row)), row.gone ? Tone::kBad : tone_of(sample.quality)};
    case Field::kAge:
      return {age_text(sample.acquired_at, moment.utc), tone_of_age(sample, about, moment.utc)};
    case Field::kRefresh:
      return {about == nullptr || about->refresh == Duration{} ? "-" : to_text(about->refresh),
              Tone::kFaint};
    case Field::kRate: return {rate_cell(row.rate.rate(moment.now)), Tone::kFaint};
  }
  return {};
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
  std::vector<Span> spans;
  for (const FieldColumn& one : fields_for(columns)) {
    if (!spans.empty()) spans.push_back({" "});
    Span cell = cell_of(one, entry_of(row), about, grouped, moment, columns);
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

}  // namespace fieldcast::cli
