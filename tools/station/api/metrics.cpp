#include "tools/station/api/metrics.hpp"

#include <fmt/format.h>

namespace fieldcast::web {

std::string metrics_text(const std::vector<Metric>& metrics) {
  std::string text;
  for (const Metric& metric : metrics) {
    text += fmt::format("# HELP fieldcast_station_{0} {1}\n# TYPE fieldcast_station_{0} {2}\n",
                        metric.name, metric.help, metric.counter ? "counter" : "gauge");
    text += fmt::format("fieldcast_station_{} {}\n", metric.name, metric.value);
  }
  return text;
}

std::vector<Metric> metrics_of(const Database* database, const Store* store,
                               const Recorder* recorder) {
  std::vector<Metric> all;
  const auto add = [&all](const char* name, bool counter, const char* help, auto value) {
    all.push_back({name, counter, help, static_cast<double>(value)});
  };
  if (database != nullptr) {
    const Database::Counters counters = database->counters();
    add("database_questions_total", true, "Queries to the store that had a response.",
        counters.answered);
    add("database_busy_total", true, "Questions refused since too many waited.", counters.busy);
    add("database_too_slow_total", true, "Questions that took too long.", counters.too_slow);
    add("database_away_total", true, "Queries to which the store did not respond.", counters.away);
    add("database_waiting", false, "Questions that wait.", counters.waiting);
  }
  if (store != nullptr) {
    const StoreCounters counters = store->counters();
    add("stored_samples_total", true, "Samples in committed transactions.", counters.stored);
    add("dropped_samples_total", true, "Samples that the store could not take.", counters.dropped);
    add("quarantined_rows_total", true, "Samples and events that the store's database refused.",
        counters.quarantined);
    add("waiting_samples", false, "Samples that wait to be stored.", counters.waiting);
  }
  if (recorder != nullptr) {
    const Recorder::Counters counters = recorder->counters();
    add("recorded_samples_total", true, "Samples handed to the store.", counters.recorded);
    add("repeated_samples_total", true, "Samples that came once more and were left out.",
        counters.repeated);
    add("unknown_samples_total", true, "Samples of channels beyond the recorder's limit.",
        counters.unknown);
    add("recorded_channels", false, "Channels that the recorder knows.", counters.channels);
  }
  return all;
}

void add_metrics_routes(RouteTable& table, const Database* database, const Store* store,
                        const Recorder* recorder, std::function<std::vector<Metric>()> further) {
  const auto handler = [=, further = std::move(further)](const HttpRequest&, const Caller&,
                                                         const Reply& reply) {
    std::vector<Metric> all = metrics_of(database, store, recorder);
    const std::vector<Metric> more = further();
    all.insert(all.end(), more.begin(), more.end());
    HttpResponse response;
    response.content_type = "text/plain; version=0.0.4; charset=utf-8";
    response.body = metrics_text(all);
    reply(std::move(response));
  };
  table.add({Method::kGet, "/metrics", Access::kViewer, handler});
}

}  // namespace fieldcast::web
