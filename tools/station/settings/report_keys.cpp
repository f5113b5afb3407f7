#include "tools/station/settings/report_keys.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "config/document/limits.hpp"
#include "config/document/scalars.hpp"
#include "tools/station/settings/item_list.hpp"
#include "tools/station/settings/text_list.hpp"

namespace fieldcast::web {
namespace {

using config::field;
using config::MapReader;
using config::Rows;

constexpr std::size_t kMaxScheduled = 64;
constexpr std::pair<std::string_view, ReportBy> kBy[] = {
    {"shift", ReportBy::kShift}, {"day", ReportBy::kDay}, {"month", ReportBy::kMonth}};
constexpr std::pair<std::string_view, bool> kEvery[] = {{"day", false}, {"month", true}};
constexpr std::pair<std::string_view, bool> kFormats[] = {{"xlsx", false}, {"csv", true}};
constexpr std::string_view kTimeForm = "a time such as 06:10";

config::Field<ReportSpec> plain(const char* name, const char* fallback, const char* text,
                                std::string_view schema) {
  return {{.name = name, .fallback = fallback, .text = text, .schema = std::string(schema)}};
}

std::string fault_of_time(const std::string& text) {
  return shifts_from(text).size() == 1 ? "" : fmt::format("'{}' is not a time of the day", text);
}

void read_times(MapReader& map, ReportSpec& report) {
  std::vector<std::string> starts;
  read_texts(map, "shifts", kTimeForm, starts, fault_of_time);
  if (!starts.empty()) {
    report.shifts = shifts_from(fmt::format("{}", fmt::join(starts, ",")));
    if (report.shifts.empty())
      map.fault("shifts", "the shifts are not in the order of time", "up to 12 times in order");
  }
  std::string at;
  if (map.read("at", at, config::TextRule{5})) {
    if (const std::string wrong = fault_of_time(at); !wrong.empty())
      return map.fault("at", "at: " + wrong, kTimeForm);
    report.at = shifts_from(at).front();
  }
  if (report.by == ReportBy::kShift && !report.shifts.empty() && report.at < report.shifts.front())
    map.fault("at", "the last shift of the day before has not ended at this time",
              fmt::format("a time from {:02}:{:02} on", report.shifts.front() / 60,
                          report.shifts.front() % 60));
}

void read_report(MapReader& map, const std::vector<NotifyTarget>& targets, ReportSpec& report) {
  report_rows().read(map, report);
  std::vector<std::string> patterns;
  if (map.require("channels", "channels: [BUS/DEVICE/CHANNEL]") != nullptr)
    read_texts(map, "channels", "BUS/DEVICE/CHANNEL with *", patterns, [](const std::string& text) {
      const auto pattern = Pattern::parse(text);
      return pattern ? "" : "channels: " + pattern.error();
    });
  for (const std::string& text : patterns)
    report.channels.push_back(Pattern::parse(text).value_or(Pattern{}));
  read_times(map, report);
  if (report.by == ReportBy::kMonth && !report.monthly)
    map.fault("by", "a day has no months", "by: day, or every: month");
  if (!report.folder.empty() && !report.folder.starts_with('/'))
    map.fault("to", "to is not an absolute path", "a folder such as /var/lib/fieldcast/reports");
  read_texts(map, "mail", "the name of a target", report.mail, [&](const std::string& name) {
    const bool known = std::ranges::any_of(targets, [&](const NotifyTarget& target) {
      return target.name == name && !target.mail.empty();
    });
    return known ? "" : fmt::format("mail: '{}' is not a target of 'notify' with mail", name);
  });
  if (!map.has("to") && !map.has("mail"))
    map.fault("name", "a report without a folder and without mail",
              "to: /var/lib/fieldcast/reports, or mail: [NAME]");
}

}  // namespace

const Rows<ReportSpec>& report_rows() {
  static const Rows<ReportSpec> rows(
      "report", "a report",
      {
          field<ReportSpec>({.name = "name",
                             .fallback = std::string(config::kNeeded),
                             .text = "begins the names of its files: `energy_2026-11-28.xlsx`"},
                            &ReportSpec::name, config::NameRule{}),
          plain("channels", "needed",
                "patterns `BUS/DEVICE/CHANNEL` of the channels, of 64 at most", kTextList),
          field<ReportSpec>({.name = "by", .fallback = "`day`", .text = "what a row stands for"},
                            &ReportSpec::by, config::ChoiceRule<ReportBy>{kBy}),
          plain("shifts", "`[\"06:00\", \"14:00\", \"22:00\"]`", "when shifts begin", kTextList),
          field<ReportSpec>({.name = "every",
                             .fallback = "`day`",
                             .text = "`day`: each day, about the day before; `month`: on the first "
                                     "of a month, about the month before"},
                            &ReportSpec::monthly, config::ChoiceRule<bool>{kEvery}),
          plain("at", "`06:10`", "when it is made, in local time", "{}"),
          field<ReportSpec>({.name = "format", .fallback = "`xlsx`", .text = "of the file"},
                            &ReportSpec::csv, config::ChoiceRule<bool>{kFormats}),
          field<ReportSpec>({.name = "to",
                             .fallback = "no file",
                             .text = "absolute path of the folder that receives the files"},
                            &ReportSpec::folder, config::TextRule{config::kMaxPath}),
          plain("mail", "no mail", "names of targets of `notify` with mail", kTextList),
      },
      "A report that is made by itself.");
  return rows;
}

void read_reports(MapReader& file, const std::vector<NotifyTarget>& targets,
                  std::vector<ReportSpec>& reports) {
  if (file.has("reports") && !file.has("store"))
    file.fault("reports", "there are no reports without a store", "store: { path: FILE }");
  read_items(file, "reports", report_rows(), kMaxScheduled, reports,
             [&](MapReader& item, ReportSpec& report) { read_report(item, targets, report); });
}

}  // namespace fieldcast::web
