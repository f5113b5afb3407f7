// Plans of small buses as texts: plans/NAME.txt has a configuration, and requests with their plans.
#include <gtest/gtest.h>

#include "core/plan/planner.hpp"
#include "tests/plan/loaded_bus.hpp"
#include "tests/support/golden.hpp"

namespace fieldcast::test {
namespace {

constexpr Slots kMostSlots = 12;  // of a table whose planned ends are shown

class PlannedBus {
 public:
  explicit PlannedBus(const std::string& head) : loaded_(head) {}

  // responses after 2ms | plan | overrun 1.2 | alternatives | groups | refresh a/b = 1s
  std::string respond(const std::string& line) {
    const auto words = words_of(line);
    if (words[0] == "responses") {
      loaded_.set_response_time(duration_of(words[2]));
      return {};
    }
    if (words[0] == "device") {  // device NAME after 20ms
      loaded_.input.devices[loaded_.device(words[1])].response_time = duration_of(words[3]);
      return {};
    }
    if (words[0] == "plan") return made(1);
    if (words[0] == "overrun") return made(std::stod(words[1]));
    if (words[0] == "alternatives") return alternatives();
    if (words[0] == "report") return reported();
    if (words[0] == "refresh") return amend(words);
    return " !! unknown: " + line + '\n';
  }

 private:
  std::string made(double overrun) {
    wire_ = std::make_unique<WireModel>(loaded_.input, loaded_.bus.planner);
    points_ = planned_points(loaded_.input, wire_->layout);
    const PlanBasis basis{*wire_, points_, overrun, {}};
    plans_ = make_plans(basis, group_points(basis));
    return shown(plans_.front());
  }
  std::string amend(const std::vector<std::string>& words) {
    const OrderIndex changed = wire_->layout.index_of[loaded_.point(words[1])];
    std::vector<PointState> states;
    for (OrderIndex at = 0; at < points_.size(); ++at) {
      if (at == changed) points_[at].refresh = duration_of(words[3]);
      states.push_back(PointState{points_[at]});
      states.back().stretch = plans_.front().points[at].stretch;
    }
    const std::vector<GroupIndex> groups{plans_.front().grouping.group_at[changed]};
    plans_.front() = amended(plans_.front(), *wire_, states, groups);
    const PlanBasis basis{*wire_, points_, 1, {}};
    return "  load of the requests " + percent_text(load_of(basis, plans_.front())) + '\n' +
           shown(plans_.front());
  }
  std::string alternatives() const {
    std::string text;
    for (const ReadPlan& plan : plans_) {
      text += "  spare " + percent_text(plan.table->spare()) + ", load " +
              percent_text(plan.table->load()) + ':';
      for (const PlannedGroup& group : plan.groups) text += ' ' + ms_text(group.phase);
      text += '\n';
    }
    return text;
  }
  std::string reported() const {
    const BusSpec& bus = loaded_.bus;
    const PlanNames names{
        [&](DeviceIndex device) { return std::string_view(bus.devices[device].name); },
        [&](DeviceIndex device, AreaIndex area) {
          return loaded_.protocols[device]->areas()[area].name;
        },
        [&](PointIndex point) { return std::vector{loaded_.name(point)}; }};
    const PlanReport report = report_of(plans_.front(), loaded_.input.points, names);
    std::string text = "  load " + percent_text(report.load) + ", stretch " +
                       factor_text(report.stretch) + ", slot " + ms_text(report.slot) +
                       ", hyperperiod " + ms_text(report.hyperperiod) + '\n';
    for (const PlanReport::Group& group : report.groups) {
      text += "  " + group.device + (group.list ? " by lists" : "") + ", load " +
              percent_text(group.load) + ", period " + ms_text(group.period) + ", phase " +
              ms_text(group.phase) + ", slack " + ms_text(group.slack) + '\n';
      for (const PlanReport::Point& point : group.points) {
        text += "    " + point.channels.front() + " = " + point.area + ' ' +
                std::to_string(point.first) + '+' + std::to_string(point.count) + ", period " +
                ms_text(point.period) + ", phase " + ms_text(point.phase) + ", gap " +
                (point.worst_gap ? ms_text(*point.worst_gap) : "none") + ", stretch " +
                factor_text(point.stretch) + '\n';
      }
    }
    return text;
  }

  [[nodiscard]] std::string shown(const ReadPlan& plan) const {
    std::string text = "  load " + percent_text(plan.load) + ", planned " +
                       percent_text(plan.planned_load()) + ", demand " + percent_text(plan.demand) +
                       ", stretch " + factor_text(plan.stretch) + ", margin " +
                       percent_text(plan.margin) + ", lightness " + factor_text(plan.lightness) +
                       ", shortest gap " + ms_text(plan.fastest) + '\n';
    if (plan.table)
      text += "  slots: " + std::to_string(plan.hyperperiod() / plan.slot()) + " of " +
              ms_text(plan.slot()) + ", spare " + percent_text(plan.table->spare()) + '\n';
    for (GroupIndex index = 0; index < plan.groups.size(); ++index) text += shown(plan, index);
    return text;
  }
  [[nodiscard]] std::string shown(const ReadPlan& plan, GroupIndex index) const {
    const Group& group = plan.grouping.groups[index];
    const PlannedGroup& planned = plan.groups[index];
    std::string text = "  group of " + loaded_.bus.devices[group.device].name +
                       (group.list ? ", lists" : "") + ": load " + percent_text(planned.load);
    if (planned.period == Duration::zero()) {
      text += ", no period";
    } else {
      const TimetableRequest& request = plan.table->request(index);
      text += ", slot " + std::to_string(request.phase) + " of " + std::to_string(request.period) +
              ", rank " + std::to_string(request.rank) + ", latest end " +
              ms_text(request.latest_end) + ", period " + ms_text(planned.period) + ", phase " +
              ms_text(planned.phase) + ", slack " + ms_text(planned.slack);
    }
    text += '\n';
    if (plan.table && plan.table->ends(index).size() <= kMostSlots) {
      text += "    ends:";
      for (const Duration end : plan.table->ends(index))
        text += end == Duration::zero() ? " -" : ' ' + ms_text(end);
      text += '\n';
    }
    for (OrderIndex at = group.begin; at < group.end; ++at) {
      const PointPlan& point = plan.points[at];
      text += "    " + loaded_.name(plan.order[at]) + ": ";
      if (point.period != Duration::zero())
        text += "slot " + std::to_string(point.first_slot) + " of " + std::to_string(point.every) +
                ", phase " + ms_text(point.phase);
      else
        text += "no period";
      if (point.worst_gap) text += ", gap " + ms_text(*point.worst_gap);
      if (point.stretch != 1) text += ", stretch " + factor_text(point.stretch);
      text += '\n';
    }
    return text;
  }

  LoadedBus loaded_;
  std::unique_ptr<WireModel> wire_;
  std::vector<PlannedPoint> points_;
  std::vector<ReadPlan> plans_;
};

class WrittenPlan : public testing::TestWithParam<std::string> {};

TEST_P(WrittenPlan, IsAsWritten) {
  expect_bus_responses<PlannedBus>(FIELDCAST_PLANS "/" + GetParam() + ".txt");
}

INSTANTIATE_TEST_SUITE_P(Files, WrittenPlan, testing::ValuesIn(golden_names(FIELDCAST_PLANS)),
                         golden_test_name);

}  // namespace
}  // namespace fieldcast::test
