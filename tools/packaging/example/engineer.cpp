#include <fmt/core.h>

#include <fieldcast/station.hpp>
using namespace fieldcast::api;

int main(int argc, char** argv) {
  Domain domain;
  domain.domain = argc > 1 ? std::stoi(argv[1]) : 0;
  Station station("engineer", domain);
  const auto plans = station.read_plans([](const ReadPlan& plan) {
    for (const ReadPlan::Group& group : plan.groups)
      for (const ReadPlan::Point& point : group.points)
        fmt::print("{}/{} is read at {}:{}\n", plan.bus, group.device, point.area, point.first);
  });
  const auto sessions = station.programming_sessions([](const ProgrammingSession& session) {
    fmt::print("{}/{} has a session: {} by {}\n", session.bus, session.device, session.state,
               session.engineer);
  });
  const Address setpoint{.at = "holding:10", .type = "float32"};
  fmt::print("write: {}\n", to_text(station.write("line/meter", setpoint, {17.5})));
  const Result result = station.acquire("line/meter", setpoint);
  fmt::print("{}: {}\n", setpoint.at, result.ok() ? to_text(result.values[0]) : to_text(result));
  std::getchar();  // waits for Enter
}
