// What a bus can carry, as texts: forecasts/NAME.txt has a configuration, and what is predicted of
// its bus, what any master needs, and what would make it feasible.
#include <gtest/gtest.h>

#include <optional>

#include "core/schedule/bus_plan.hpp"
#include "core/schedule/overload.hpp"
#include "tests/plan/loaded_bus.hpp"
#include "tests/support/golden.hpp"

namespace fieldcast::test {
namespace {

class ForecastBus {
 public:
  explicit ForecastBus(const std::string& head) : loaded_(head) {}

  // responses after 2ms | input | check | forecast | points | requests | bound | remedies
  std::string respond(const std::string& line) {
    const auto words = words_of(line);
    if (words[0] == "responses") {
      plan_ = make_plan(loaded_.bus, duration_of(words[2]));
      return {};
    }
    if (!plan_) plan_ = make_plan(loaded_.bus, kAssumedResponseTime);
    if (words[0] == "input") return input();
    if (words[0] == "check") return checked();
    if (words[0] == "forecast") return forecast();
    if (words[0] == "points") return points();
    if (words[0] == "requests") return requests();
    if (words[0] == "bound") return bound();
    if (words[0] == "remedies") return remedies();
    return " !! unknown: " + line + '\n';
  }

 private:
  [[nodiscard]] const Prediction& prediction() const { return plan_->prediction; }

  [[nodiscard]] std::string input() const {
    const ScheduleInput& input = plan_->input;
    std::string text =
        "  silence " + ms_text(input.silence) + ", lead " + ms_text(input.lead) + '\n';
    for (PointIndex index = 0; index < input.points.size(); ++index) {
      const Point& point = input.points[index];
      text += "  " + loaded_.name(index) + ": refresh " + to_text(point.refresh) + ", " +
              std::string(to_text(point.mode)) + ", priority " + std::to_string(point.priority) +
              ", elasticity " + factor_text(point.elasticity) + '\n';
    }
    text += "  read by themselves:";
    for (const auto& point : plan_->point_of)
      text += point ? ' ' + std::to_string(*point) : std::string(" -");
    return text + '\n';
  }
  [[nodiscard]] std::string checked() const {
    const auto overload = overload_of(loaded_.bus, plan_->response_time);
    const auto hopeless = hopeless_load_of(loaded_.bus);
    return "  requested load " + percent_text(asked_load(plan_->input, loaded_.bus.planner)) +
           '\n' + "  " + (overload ? to_text(*overload) : "no overload") + '\n' +
           (hopeless ? "  hopeless: " + factor_text(*hopeless) + '\n' : "");
  }
  [[nodiscard]] std::string forecast() const {
    const Prediction& made = prediction();
    return std::string("  ") + (made.feasible ? "feasible" : "not feasible") +
           (made.narrow ? ", narrow" : "") + ", planned load " + percent_text(made.planned_load) +
           ", stretch " + factor_text(made.stretch) + '\n' + "  run of " + ms_text(made.horizon) +
           " ms" + ": load " + percent_text(made.load) + ", " + std::to_string(made.reads) +
           " reads, " + std::to_string(made.missed) + " late\n";
  }
  [[nodiscard]] std::string points() const {
    std::string text;
    for (PointIndex index = 0; index < prediction().points.size(); ++index) {
      const PointForecast& point = prediction().points[index];
      text += "  " + loaded_.name(index) + ": refresh " + to_text(point.refresh) + ", " +
              std::to_string(point.reads) + " reads, longest gap " + ms_text(point.worst_gap) +
              ", " + std::to_string(point.missed) + " late\n";
    }
    return text;
  }
  [[nodiscard]] std::string requests() const {
    std::string text;
    for (const BlockForecast& block : prediction().blocks) {
      text += "  " + loaded_.bus.devices[block.device].name + ':';
      for (const Range& range : block.ranges) {
        text += ' ' + std::string(loaded_.protocols[block.device]->areas()[range.area].name) + ' ' +
                std::to_string(range.first) + '+' + std::to_string(range.count);
      }
      text += ", " + std::to_string(block.points) + " points, " + ms_text(block.cost) + ", " +
              factor_text(block.per_second) + " a second\n";
    }
    return text;
  }
  [[nodiscard]] std::string bound() const {
    if (!plan_->bound) return "  not known\n";
    const LoadBound& bound = *plan_->bound;
    std::string text = "  any master needs " + percent_text(bound.load);
    if (const auto share = share_of_possible(*plan_))
      text += ", which is " + percent_text(*share) + " of the plan";
    const auto proven = proven_load(plan_->input, bound.prices);
    text += std::string(", proven ") + (proven ? percent_text(*proven) : "no") + '\n';
    for (PointIndex index = 0; index < bound.prices.size(); ++index)
      text += "    " + loaded_.name(index) + " pays " + ms_text(bound.prices[index]) + '\n';
    return text;
  }
  [[nodiscard]] std::string remedies() const {
    std::string text;
    for (const std::string& way : advice(*plan_)) text += "  " + way + '\n';
    return text.empty() ? "  none is needed\n" : text;
  }

  LoadedBus loaded_;
  std::optional<BusPlan> plan_;
};

class WrittenForecast : public testing::TestWithParam<std::string> {};

TEST_P(WrittenForecast, IsAsWritten) {
  expect_bus_responses<ForecastBus>(FIELDCAST_FORECASTS "/" + GetParam() + ".txt");
}

INSTANTIATE_TEST_SUITE_P(Files, WrittenForecast,
                         testing::ValuesIn(golden_names(FIELDCAST_FORECASTS)), golden_test_name);

}  // namespace
}  // namespace fieldcast::test
