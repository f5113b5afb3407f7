#include "tools/cli/screen/channel_rows.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <string_view>
#include <variant>

namespace fieldcast::cli {

namespace {

char lower(char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c; }

struct Sortable {
  const ChannelEntry* entry;
  Rank rank;
  double key = 0;
};

std::string searched_text(const ChannelEntry& entry, const StationChannel* about) {
  const auto& row = entry.second;
  std::string text = entry.first.text() + ' ';
  text += row.gone ? "GONE" : to_text(row.sample.quality);
  if (about != nullptr) text += ' ' + about->unit;
  return text;
}

double sort_key(const ChannelEntry& entry, ChannelOrder order, Instant now) {
  const auto& row = entry.second;
  switch (order) {
    case ChannelOrder::kValue:  // greatest first, texts last
      return -trend_value(row.sample.value).value_or(-std::numeric_limits<double>::max());
    case ChannelOrder::kAge: return static_cast<double>(row.sample.acquired_at.nanoseconds);
    case ChannelOrder::kRate: return -row.rate.rate(now);
    default: return 0;
  }
}

void sort(std::vector<Sortable>& all, const ChannelChoice& choice) {
  const bool by_rank = choice.order == ChannelOrder::kBadFirst;
  const auto before = [by_rank](const Sortable& a, const Sortable& b) {
    return by_rank ? a.rank < b.rank : a.key < b.key;
  };
  if (choice.order == ChannelOrder::kName) {
    if (choice.inverted) std::ranges::reverse(all);
  } else if (choice.inverted) {
    std::ranges::stable_sort(all, [&](const auto& a, const auto& b) { return before(b, a); });
  } else {
    std::ranges::stable_sort(all, before);
  }
}

struct Group {
  ListRow row;
  std::vector<Sortable> channels;  // of a device
  std::vector<Group> devices;      // of a bus
};

void count(ListRow& group, Rank rank) {
  ++group.members;
  group.good += rank == Rank::kGood ? 1 : 0;
  group.bad += rank == Rank::kBad ? 1 : 0;
  group.rank = std::min(group.rank, rank);
}

Group& last_group(std::vector<Group>& groups, const ChannelPath& id) {
  if (groups.empty() || groups.back().row.id != id) {
    groups.emplace_back();
    groups.back().row.id = id;
  }
  return groups.back();
}

void sort_groups(std::vector<Group>& groups, const ChannelChoice& choice) {
  if (choice.order == ChannelOrder::kBadFirst)
    std::ranges::stable_sort(groups, {}, [](const Group& group) { return group.row.rank; });
  if (choice.inverted) std::ranges::reverse(groups);
}

ListRow channel_row(const Sortable& one) {
  ListRow row;
  row.id = one.entry->first;
  row.rank = one.rank;
  row.item = one.entry;
  return row;
}

// REQUIRES: `all` is sorted by name.
ListRows grouped(const std::vector<Sortable>& all, const ChannelChoice& choice,
                 const RowList& list) {
  std::vector<Group> buses;
  for (const Sortable& one : all) {
    const ChannelPath& path = one.entry->first;
    Group& bus = last_group(buses, {path.bus, {}, {}});
    Group& device = last_group(bus.devices, {path.bus, path.device, {}});
    count(bus.row, one.rank);
    count(device.row, one.rank);
    device.channels.push_back(one);
  }
  ListRows rows;
  const auto add_group = [&](Group& group) {
    group.row.folded = list.is_folded(group.row.id);
    rows.push_back(group.row);
    return !group.row.folded;
  };
  sort_groups(buses, choice);
  for (Group& bus : buses) {
    if (!add_group(bus)) continue;
    sort_groups(bus.devices, choice);
    for (Group& device : bus.devices) {
      if (!add_group(device)) continue;
      sort(device.channels, choice);
      for (const Sortable& one : device.channels) rows.push_back(channel_row(one));
    }
  }
  return rows;
}

}  // namespace

std::string_view order_text(ChannelOrder order) {
  switch (order) {
    case ChannelOrder::kBadFirst: return "bad first";
    case ChannelOrder::kName: return "name";
    case ChannelOrder::kValue: return "value";
    case ChannelOrder::kAge: return "age";
    case ChannelOrder::kRate: return "rate";
    case ChannelOrder::kCount: break;
  }
  return "?";
}

Rank rank_of(const WatchModel::Row& row) {
  if (row.gone) return Rank::kBad;
  switch (row.sample.quality) {
    case Quality::kGood: return Rank::kGood;
    case Quality::kUncertain: return Rank::kUncertain;
    case Quality::kNotYetRead: return Rank::kUnread;
    default: return Rank::kBad;
  }
}

std::vector<std::string> filter_words(std::string_view filter) {
  std::vector<std::string> words(1);
  for (const char c : filter) {
    if (c == ' ')
      words.emplace_back();
    else
      words.back() += lower(c);
  }
  std::erase(words, std::string{});
  return words;
}

bool has_words(std::string_view text, const std::vector<std::string>& words) {
  return std::ranges::all_of(words, [&](const std::string& word) {
    // std::ranges::search of GCC 12's library does not compile with clang 14.
    return std::search(text.begin(), text.end(), word.begin(), word.end(),
                       [](char a, char b) { return lower(a) == b; }) != text.end();
  });
}

ChannelRows channel_rows(const WatchModel& model, const ChannelChoice& choice, const RowList& list,
                         Instant now) {
  const auto words = filter_words(choice.filter);
  ChannelRows result;
  std::vector<Sortable> chosen;
  chosen.reserve(model.rows().size());
  for (const ChannelEntry& entry : model.rows()) {
    const Rank rank = rank_of(entry.second);
    ++result.channels;
    result.good += rank == Rank::kGood ? 1 : 0;
    result.bad += rank == Rank::kBad ? 1 : 0;
    if (choice.bad_only && rank == Rank::kGood) continue;
    if (!words.empty() &&
        !has_words(searched_text(entry, model.catalogue().find(entry.first)), words))
      continue;
    chosen.push_back({&entry, rank, sort_key(entry, choice.order, now)});
  }
  result.matching = chosen.size();
  if (choice.grouped) {
    result.rows = grouped(chosen, choice, list);
  } else {
    sort(chosen, choice);
    for (const Sortable& one : chosen) result.rows.push_back(channel_row(one));
  }
  return result;
}

namespace {

constexpr std::array<std::string_view, 8> kEighths{"▁", "▂", "▃", "▄", "▅", "▆", "▇", "█"};
constexpr std::array<std::string_view, 8> kAscii{"_", ".", ",", "-", "=", "+", "*", "#"};

}  // namespace

std::optional<double> trend_value(const Value& value) {
  return std::visit(
      [](const auto& one) -> std::optional<double> {
        using T = std::decay_t<decltype(one)>;
        if constexpr (std::is_same_v<T, std::string>) {
          return std::nullopt;
        } else {
          const auto number = static_cast<double>(one);
          return std::isfinite(number) ? std::optional(number) : std::nullopt;
        }
      },
      value);
}

void TrendHistory::follow(const ChannelPath& path) {
  if (!points_.try_emplace(path).second) return;
  order_.push_back(path);
  if (order_.size() <= kMostChannels) return;
  points_.erase(order_.front());
  order_.pop_front();
}

void TrendHistory::add(const ChannelPath& path, const Value& value, UtcTime at) {
  const auto found = points_.find(path);
  if (found == points_.end()) return;
  const auto number = trend_value(value);
  if (!number) return;
  TrendPoints& points = found->second;
  if (!points.empty() && points.back().at.nanoseconds == at.nanoseconds) return;
  points.push_back({at, *number});
  if (points.size() > kMostPoints) points.pop_front();
}

const TrendPoints* TrendHistory::find(const ChannelPath& path) const {
  const auto found = points_.find(path);
  return found == points_.end() ? nullptr : &found->second;
}

std::string sparkline(const TrendPoints& points, std::size_t columns, bool unicode) {
  const std::size_t count = std::min(points.size(), columns);
  if (count == 0) return {};
  const auto first = points.end() - static_cast<std::ptrdiff_t>(count);
  const auto [least, most] = std::minmax_element(
      first, points.end(), [](const auto& a, const auto& b) { return a.value < b.value; });
  const double low = least->value, span = most->value - low;
  std::string line;
  for (auto point = first; point != points.end(); ++point) {
    const double share = span > 0 && std::isfinite(span) ? (point->value - low) / span : 0;
    const auto step = std::min<std::size_t>(7, static_cast<std::size_t>(share * 8));
    line += (unicode ? kEighths : kAscii)[step];
  }
  return line;
}

}  // namespace fieldcast::cli
