#include <fmt/core.h>

#include <fieldcast/station.hpp>
using namespace fieldcast::api;
using namespace std::chrono_literals;

int main(int argc, char** argv) {
  Domain domain;
  domain.domain = argc > 1 ? std::stoi(argv[1]) : 0;
  Station station("my-station", domain);
  const auto catalogue = station.catalogue("*", [](const Channel& c) {
    fmt::print("found {}: {} {} at {}\n", c.path.text(), c.type, c.unit, c.address);
  });
  const auto on_sample = [](const Sample& s) {
    fmt::print("{} {} {}, {} ms old\n", s.path.text(), to_text(s.value), to_text(s.quality),
               age(s) / 1ms);
  };
  const auto on_missed = [](const Path& path) { fmt::print("late: {}\n", path.text()); };
  const auto values = station.subscribe("*", on_sample, {.refresh = 1s, .on_missed = on_missed});
  const CommandOptions options{.verify = true};  // the bridge reads the value back
  fmt::print("write: {}\n", to_text(station.write("line/meter/setpoint", 42, options)));
  std::getchar();  // waits for Enter
}
