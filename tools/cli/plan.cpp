#include "tools/cli/plan.hpp"

#include <ostream>
#include <utility>

#include "config/loader.hpp"
#include "tools/cli/bus_plan.hpp"
#include "tools/cli/plan_view.hpp"

namespace fieldcast::cli {

ExitCode plan(const PlanOptions& options, std::ostream& out, std::ostream& err, const Screen& screen) {
  const auto loaded = config::load_file(options.config);
  if (!loaded) {
    err << config::to_text(loaded.error()) << '\n';
    return ExitCode::kUsage;
  }
  auto verdict = ExitCode::kOk;
  bool first = true;
  for (const auto& bus : loaded->buses) {
    const auto plan = make_plan(bus, options.answer_time);
    if (!plan.prediction.feasible) verdict = ExitCode::kFound;
    if (options.json) {
      out << to_line(plan_json(plan)) << '\n';
      continue;
    }
    if (!std::exchange(first, false)) out << '\n';
    for (const auto& line : plan_lines(plan, screen)) out << line << '\n';
  }
  out.flush();
  return verdict;
}

}  // namespace fieldcast::cli
