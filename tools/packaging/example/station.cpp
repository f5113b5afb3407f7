#include <fmt/core.h>

#include <fieldcast/station.hpp>
using namespace fieldcast;
using namespace std::chrono_literals;

int main(int argc, char** argv) {
  DdsSpec dds;
  dds.domain = argc > 1 ? std::stoi(argv[1]) : 0;
  Station station(dds, "my-station");
  station.subscribe_channels([](const StationChannel& c) {
    fmt::print("found {}: {} {} at {}\n", c.path(), c.type, c.unit, c.at);
  });
  const auto on_sample = [](const StationSample& s) {
    fmt::print("{} {} {}, {} ms old\n", s.path(), to_text(s.value), to_text(s.quality),
               age(s) / 1ms);
  };
  const auto on_missed = [](auto& bus, auto& device, auto& channel) {
    fmt::print("late: {}/{}/{}\n", bus, device, channel);
  };
  station.subscribe_samples(on_sample, {}, {.deadline = 1s, .on_deadline_missed = on_missed});
  const bool verify = true;  // read it back
  fmt::print("write: {}\n", to_text(station.write("line/meter/setpoint", 42, verify)));
  std::getchar();  // waits for Enter
}
