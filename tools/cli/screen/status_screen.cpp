#include "tools/cli/screen/status_screen.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <numeric>
#include <set>
#include <utility>

#include "tools/cli/model/sample_text.hpp"
#include "tools/cli/screen/status_rows.hpp"
#include "tools/cli/text/cell_text.hpp"
#include "tools/cli/view/status/status_facts.hpp"

namespace fieldcast::cli {
namespace {

const std::array kStatusBar{
    BarKey{"F1", "help", function_key(1)}, BarKey{"/", "filter", text_key("/")},
    BarKey{"s", "sort", text_key("s")},    BarKey{"b", "bad only", text_key("b")},
    BarKey{"d", "details", text_key("d")}, BarKey{"q", "quit", text_key("q")},
};

constexpr std::array<std::string_view, 24> kStatusHelp{
    "",
    "Up Down PgUp PgDn Home End: move (j and k too; the wheel scrolls)",
    "Enter, Space, Left, Right: fold and unfold a bus (or click it)",
    "/ F3 F4: filter, words that name, state or causes must have; Esc clears it",
    "s F6: bad first, or by name",
    "b: only what is not as it should be",
    "d: details of the selected row, or more rows",
    "q F10: quit (Ctrl-C too)",
    "",
    "wire: share of the last second in which the wire of the bus was busy",
    "responds in: from the end of a request to the first byte of its response",
    "timeout: how long the bridge waits for a response; learned, at most the configured one",
    "exchanges: requests with their responses, since the bridge started",
    "failed: exchanges without a valid response; the details have their causes",
    "missed: refreshes that passed without a new value",
    "planned: share of the wire that all refreshes take together, by the plan",
    "reading: share of the wire that reading took in the last 10 s",
    "overloaded: the plan needs more than the whole wire, every refresh takes longer",
    "gap: unused addresses between two channels; a block runs across them to save a request, "
    "unless the device refuses that",
    "degraded: some exchanges with the device fail, offline: all do",
    "leased: an engineer programs a device of the bus",
    "group: bridges that stand by for each other; behind: blocks of the master not followed yet",
    "",
    "docs/qualities.md explains the causes and what to do.",
};

struct StatusColumns {
  std::size_t name = 0, state = 10, load = 0, exchanges = 0, failed = 0, missed = 0;
};

StatusColumns columns_for(std::size_t columns) {
  StatusColumns widths;
  if (columns < 30) widths.state = 8;
  if (columns >= 44) widths.load = 11;
  if (columns >= 56) widths.missed = 8;
  if (columns >= 74) widths.exchanges = 10, widths.failed = 8;
  const std::size_t used = widths.state + widths.load + widths.exchanges + widths.failed +
                           widths.missed + (widths.load != 0 ? 1 : 0) +
                           (widths.exchanges != 0 ? 2 : 0) + (widths.missed != 0 ? 1 : 0) + 1;
  widths.name = columns - std::min(columns, used);
  return widths;
}

struct StatusCells {
  std::string name;
  Span state;
  std::string load, exchanges, failed, missed;
};

FrameLine line_of(const StatusCells& cells, std::size_t columns, bool head) {
  const StatusColumns widths = columns_for(columns);
  std::vector<Span> spans;
  const auto add = [&](const std::string& text, std::size_t width, Align align, Tone tone) {
    if (width == 0) return;
    if (!spans.empty()) spans.push_back({" "});
    spans.push_back({fitted(text, width, align), tone});
  };
  const Tone bad = head ? Tone::kPlain : Tone::kWarning;
  const auto counted = [&](const std::string& text) { return text == "0" ? Tone::kPlain : bad; };
  add(cells.name, widths.name, Align::kLeft, head ? Tone::kPlain : Tone::kTitle);
  add(cells.state.text, widths.state, Align::kLeft, cells.state.tone);
  add(cells.load, widths.load, Align::kRight, Tone::kPlain);
  add(cells.exchanges, widths.exchanges, Align::kRight, Tone::kPlain);
  add(cells.failed, widths.failed, Align::kRight, counted(cells.failed));
  add(cells.missed, widths.missed, Align::kRight, counted(cells.missed));
  return full_line(std::move(spans), columns, head);
}

std::uint64_t total(const CauseCounts& causes) {
  return std::accumulate(causes.begin(), causes.end(), std::uint64_t{0},
                         [](std::uint64_t sum, const auto& one) { return sum + one.second; });
}

StatusCells bus_cells(const StationBusStatus& bus) {
  const bool overloaded = bus.report.state == BusState::kRunning && bus.report.stretch > 1;
  StatusCells cells;
  cells.state = {overloaded ? "overloaded" : std::string(to_text(bus.report.state)),
                 overloaded ? Tone::kWarning : tone_of(bus.report.state)};
  cells.load = "wire " + percent_text(bus.report.utilisation);
  cells.exchanges = std::to_string(bus.report.exchanges);
  cells.failed = std::to_string(total(bus.causes));
  cells.missed = std::to_string(bus.report.deadline_misses);
  return cells;
}

StatusCells device_cells(const StationDeviceStatus& device) {
  StatusCells cells;
  cells.state = {std::string(to_text(device.report.state)), tone_of(device.report.state)};
  cells.load = milliseconds_text(device.report.response_time);
  cells.exchanges = std::to_string(device.report.exchanges);
  cells.failed = std::to_string(device.report.failures);
  cells.missed = std::to_string(device.report.deadline_misses);
  return cells;
}

StatusCells standby_cells(const StatusModel& model, const ChannelPath& id) {
  StatusCells cells;
  if (id.device.empty()) {
    const bool served = master_of(model.members, standby_group_of(id)) != nullptr;
    cells.state = served ? Span{"served", Tone::kGood} : Span{"no master", Tone::kBad};
  } else if (const StandbyMessage* member = member_of(model, id)) {
    cells.state = {role_text(*member), tone_of(*member)};
    if (member->member.role == StandbyRole::kWaiting)
      cells.load = fmt::format("{} behind", behind(model.members, *member));
  }
  return cells;
}

}  // namespace

void StatusScreen::rebuild(const Moment& moment) {
  control_.list.assign(
      status_rows(model_, {by_name_, bad_only_, control_.filter.text()}, control_.list));
  control_.stale = false;
  sorted_at_ = moment.now;
}

bool StatusScreen::on_key(const Key& given, const Moment& moment) {
  const Key key = control_.bar_key(given).value_or(given);
  const bool in_list = control_.mode == ListControl::Mode::kList;
  const bool sorts = in_list && is_key(key, "s", 6), hides = in_list && is_key(key, "b", -1);
  auto took = ListControl::Took::kKey;
  if (sorts)
    by_name_ = !by_name_;
  else if (hides)
    bad_only_ = !bad_only_;
  else
    took = control_.on_key(key);
  if (control_.stale || sorts || hides) rebuild(moment);
  return took != ListControl::Took::kQuit;
}

FrameLine StatusScreen::title(const Moment& moment, std::size_t columns) const {
  std::size_t online = 0, running = 0;
  for (const auto& [key, device] : model_.devices)
    online += device.report.state == DeviceState::kOnline ? 1 : 0;
  for (const auto& [name, bus] : model_.buses)
    running += bus.report.state == BusState::kRunning ? 1 : 0;
  const std::size_t devices = model_.devices.size(), buses = model_.buses.size();
  std::set<std::string> groups, served;
  for (const auto& [key, member] : model_.members) {
    groups.insert(key.first);
    if (master_of(model_.members, key.first) != nullptr) served.insert(key.first);
  }
  const bool well = online == devices && running == buses && served == groups;
  const std::array pieces{
      std::string(columns < 44 ? "status" : "fieldcast status"),
      fmt::format("{}/{} online", online, devices),
      fmt::format("{} of {} buses running", running, buses),
      groups.empty() ? std::string{}
                     : fmt::format("{} of {} groups served", served.size(), groups.size()),
      std::string(by_name_ ? "sort: name" : "sort: bad first"),
      control_.filter.text().empty() ? std::string{} : "filter: " + shown(control_.filter.text()),
  };
  return title_line({fitting_pieces(pieces, columns), well ? Tone::kTitle : Tone::kWarning},
                    clock_text(moment.utc), columns);
}

FrameLine StatusScreen::row_line(const ListRow& row, std::size_t columns) const {
  const char* fold = !row.is_group() ? "  " : row.folded ? "+ " : "- ";
  const char* indent = columns < 44 ? " " : "    ";
  StatusCells cells;
  if (!standby_group_of(row.id).empty()) {
    cells = standby_cells(model_, row.id);
  } else if (row.is_bus()) {
    const auto found = model_.buses.find(row.id.bus);
    if (found != model_.buses.end()) cells = bus_cells(found->second);
  } else {
    const auto found = model_.devices.find({row.id.bus, row.id.device});
    if (found != model_.devices.end()) cells = device_cells(found->second);
  }
  cells.name = row.is_bus() ? fold + shown(row.id.bus) : indent + shown(row.id.device);
  return line_of(cells, columns, false);
}

Frame StatusScreen::frame(const Moment& moment, const Screen& screen) {
  const std::size_t known = model_.buses.size() + model_.devices.size() + model_.members.size();
  if (control_.stale || !sorted_at_ || moment.now - *sorted_at_ >= kSortAgain ||
      std::exchange(known_, known) != known)
    rebuild(moment);
  std::vector<FrameLine> below;
  if (const ListRow* row = control_.list.selected(); row != nullptr && control_.details)
    below = status_details(model_, row->id, moment.utc, screen.columns);
  Layout layout = layout_of(screen, below.size());
  layout.list_top -= layout.state;  // the title already contains this information
  layout.list_rows += std::exchange(layout.state, 0);
  ScreenParts parts;
  parts.title = title(moment, screen.columns);
  parts.head = line_of({"bus, device", {"state"}, "responds in", "exchanges", "failed", "missed"},
                       screen.columns, true);
  parts.row = [&](const ListRow& row, std::size_t columns) { return row_line(row, columns); };
  parts.pane = std::move(below);
  parts.notice = known == 0  ? shown(notice_)
                 : bad_only_ ? std::string("all is as it should be (b shows it)")
                             : std::string("nothing matches the filter (Esc)");
  parts.bar = kStatusBar;
  parts.help = kStatusHelp;
  return control_.compose(layout, parts);
}

}  // namespace fieldcast::cli
