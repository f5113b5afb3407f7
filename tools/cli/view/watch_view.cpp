#include "tools/cli/view/watch_view.hpp"

#include <fmt/format.h>

#include <array>
#include <cstdio>

#include "tools/cli/model/sample_text.hpp"

namespace fieldcast::cli {
namespace {

std::string rate_text(double rate) {
  std::array<char, 32> buffer{};
  std::snprintf(buffer.data(), buffer.size(), rate < 10 ? "%.1f/s" : "%.0f/s", rate);
  return buffer.data();
}

// Warns above twice the refresh, because the bridge itself may have stopped.
Tone age_tone(const StationSample& sample, const StationChannel* about, UtcTime now) {
  if (about == nullptr || about->refresh == Duration{} || sample.acquired_at.nanoseconds == 0)
    return Tone::kFaint;
  return now.nanoseconds - sample.acquired_at.nanoseconds > 2 * about->refresh.count()
             ? Tone::kWarning
             : Tone::kPlain;
}

std::vector<Cell> cells_of(const ChannelPath& path, const WatchModel::Row& row,
                           const StationChannel* about, Instant now, UtcTime utc) {
  const auto& sample = row.sample;
  const bool read = sample.acquired_at.nanoseconds != 0;
  return {{path.text()},
          {read ? value_text(sample.value, about != nullptr ? about->type : std::string{}) : "-",
           Tone::kTitle},
          {about != nullptr ? about->unit : ""},
          row.gone ? Cell{"GONE", Tone::kBad}
                   : Cell{quality_text(sample, about), tone_of(sample.quality)},
          {age_text(sample.acquired_at, utc), age_tone(sample, about, utc)},
          {about == nullptr || about->refresh == Duration{} ? "-" : to_text(about->refresh),
           Tone::kFaint},
          {rate_text(row.rate.rate(now)), Tone::kFaint}};
}

}  // namespace

std::vector<std::string> watch_lines(const WatchModel& model, Instant now, UtcTime utc,
                                     const Screen& screen) {
  const auto& rows = model.rows();
  const auto lag = model.lag_remark();
  const std::size_t around = lag ? 4 : 3;  // title, head, remainder, lag remark
  const bool cut = screen.rows != 0 && rows.size() + around - 1 > screen.rows;
  const std::size_t shown = !cut ? rows.size() : screen.rows > around ? screen.rows - around : 1;

  TextTable table({{"channel"},
                   {"value", Align::kRight},
                   {"unit"},
                   {"quality"},
                   {"age", Align::kRight},
                   {"refresh", Align::kRight},
                   {"rate", Align::kRight}});
  for (const auto& [path, row] : rows) {
    if (table.rows() == shown) break;
    table.add_row(cells_of(path, row, model.catalogue().find(path), now, utc));
  }

  const auto title = fmt::format("fieldcast watch {}   {}   {}   {}", model.pattern().text(),
                                 model.summary(), rate_text(model.rate(now)), utc_text(utc));
  std::vector<std::string> lines{screen.columns == 0 ? title : clip(title, screen.columns)};
  for (auto& line : table.render(screen)) lines.push_back(std::move(line));
  if (cut) {
    const auto more =
        fmt::format(".. and {} more: narrow the pattern (BUS/DEVICE), or a taller terminal",
                    rows.size() - shown);
    lines.push_back(screen.columns == 0 ? more : clip(more, screen.columns));
  }
  if (lag) lines.push_back(screen.columns == 0 ? *lag : clip(*lag, screen.columns));
  return lines;
}

Json lag_json(const Station::BlockCounters& counters) {
  return {{"event", "too_slow"},
          {"blocks_missed", counters.missing},
          {"last_values_requests", counters.requests}};
}

}  // namespace fieldcast::cli
