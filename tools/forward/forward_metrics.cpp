#include "tools/forward/forward_metrics.hpp"

#include <fmt/format.h>

#include <iterator>
#include <string_view>

#include "core/base/value.hpp"

namespace fieldcast::forward {

namespace {

struct Row {
  std::string_view name;  // of a counter: without "_total"
  bool is_counter;
  std::string_view unit;  // the suffix of the name, or empty
  std::string_view help;
  std::string (*value)(const SiteStatus&);
};

std::string number(std::uint64_t value) { return std::to_string(value); }
std::string number(Duration value) { return number_text(to_seconds(value)); }

constexpr Row kRows[] = {
    {"fieldcast_forward_connected", false, "", "1 while the engine accepts messages.",
     [](const SiteStatus& status) { return number(std::uint64_t{status.is_connected}); }},
    {"fieldcast_forward_queue_messages", false, "", "Messages that wait for an acknowledgement.",
     [](const SiteStatus& status) { return number(status.backlog_records); }},
    {"fieldcast_forward_queue_bytes", false, "bytes", "Bytes of these messages.",
     [](const SiteStatus& status) { return number(status.backlog_bytes); }},
    {"fieldcast_forward_queue_age_seconds", false, "seconds",
     "Time for which the oldest message has waited; 0 for an empty queue.",
     [](const SiteStatus& status) {
       const bool is_empty = status.oldest_at.nanoseconds == 0;
       return number(is_empty ? Duration{}
                              : Duration{status.at.nanoseconds - status.oldest_at.nanoseconds});
     }},
    {"fieldcast_forward_samples", true, "", "Samples that the engine has acknowledged.",
     [](const SiteStatus& status) { return number(status.acknowledged_samples); }},
    {"fieldcast_forward_late_samples", true, "", "Those of them that were late.",
     [](const SiteStatus& status) { return number(status.late_samples); }},
    {"fieldcast_forward_messages", true, "", "Messages that the engine has acknowledged.",
     [](const SiteStatus& status) { return number(status.acknowledged_messages); }},
    {"fieldcast_forward_acknowledged_bytes", true, "bytes", "Bytes of these messages.",
     [](const SiteStatus& status) { return number(status.acknowledged_bytes); }},
    {"fieldcast_forward_repeated_messages", true, "", "Messages that were sent again.",
     [](const SiteStatus& status) { return number(status.repeated_messages); }},
    {"fieldcast_forward_refused_messages", true, "", "Messages that the engine has refused.",
     [](const SiteStatus& status) { return number(status.refused_messages); }},
    {"fieldcast_forward_thinned_samples", true, "", "Samples thinned out because of a full queue.",
     [](const SiteStatus& status) { return number(status.thinned_samples); }},
    {"fieldcast_forward_dropped_samples", true, "", "Samples dropped because of a full queue.",
     [](const SiteStatus& status) { return number(status.dropped_samples); }},
    {"fieldcast_forward_lost_samples", true, "", "Samples lost because the queue was not written.",
     [](const SiteStatus& status) { return number(status.lost_samples); }},
    {"fieldcast_forward_open_gaps", false, "", "Gaps whose missing samples are fetched.",
     [](const SiteStatus& status) { return number(status.open_gaps); }},
};

}  // namespace

std::string metrics_text(const SiteStatus& status, MetricsFormat format) {
  std::string text;
  const bool is_open = format == MetricsFormat::kOpenMetrics;
  for (const Row& row : kRows) {
    const std::string_view total = row.is_counter ? "_total" : "";
    const std::string_view family_total = is_open ? "" : total;
    const std::string_view type = row.is_counter ? "counter" : "gauge";
    const auto out = std::back_inserter(text);
    fmt::format_to(out, "# TYPE {}{} {}\n", row.name, family_total, type);
    if (is_open && !row.unit.empty()) fmt::format_to(out, "# UNIT {} {}\n", row.name, row.unit);
    fmt::format_to(out, "# HELP {}{} {}\n", row.name, family_total, row.help);
    fmt::format_to(out, "{}{}{{site=\"{}\"}} {}\n", row.name, total, escaped_label(status.site),
                   row.value(status));
  }
  if (is_open) text += "# EOF\n";
  return text;
}

}  // namespace fieldcast::forward
