#include "tests/plan/loaded_bus.hpp"

#include <charconv>
#include <cmath>
#include <cstdio>
#include <sstream>
#include <stdexcept>

#include "config/loader/loader.hpp"

namespace fieldcast::test {

LoadedBus::LoadedBus(const std::string& text) {
  const auto loaded = config::load_text(text, "golden.yaml", {});
  if (!loaded) throw std::runtime_error(to_text(loaded.error().front()));
  bus = loaded->buses.front();
  std::vector<const Protocol*> pointers;
  for (const DeviceSpec& each : bus.devices) {
    protocols.push_back(make_protocol(each, line_of(bus.port)).value());
    pointers.push_back(protocols.back().get());
  }
  map = map_points(bus);
  input = schedule_input(bus, pointers, map.points, kAssumedResponseTime);
}

std::string LoadedBus::name(PointIndex point) const {
  std::string text;
  ChannelIndex index = 0;
  for (const DeviceSpec& each : bus.devices) {
    for (const ChannelSpec& channel : each.channels) {
      if (map.point_of[index++] != point) continue;
      text += (text.empty() ? each.name + '/' : "+") + channel.name;
    }
  }
  return text;
}

DeviceIndex LoadedBus::device(const std::string& name) const {
  for (DeviceIndex index = 0; index < bus.devices.size(); ++index) {
    if (bus.devices[index].name == name) return index;
  }
  throw std::runtime_error("no device " + name);
}

PointIndex LoadedBus::point(const std::string& name) const {
  ChannelIndex index = 0;
  for (const DeviceSpec& each : bus.devices) {
    for (const ChannelSpec& channel : each.channels) {
      if (each.name + '/' + channel.name == name) return map.point_of[index].value();
      ++index;
    }
  }
  throw std::runtime_error("no channel " + name);
}

void LoadedBus::set_response_time(Duration time) {
  for (DeviceTiming& each : input.devices) each.response_time = time;
}

namespace {
std::string printed(const char* format, double number) {
  char text[40];
  std::snprintf(text, sizeof text, format, number);
  return text;
}
}  // namespace

std::string ms_text(Duration time) {
  return printed("%.3f", static_cast<double>(time.count()) / 1e6);
}
std::string percent_text(double share) { return printed("%.2f %%", 100 * share); }
std::string factor_text(double factor) {
  return printed("%g", std::round(factor * 10'000) / 10'000);
}

std::vector<std::string> words_of(const std::string& line) {
  std::istringstream in(line);
  std::vector<std::string> words;
  for (std::string word; in >> word;) words.push_back(word);
  return words;
}

Duration duration_of(const std::string& text) {
  double number = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  const std::string_view unit(end, static_cast<std::size_t>(text.data() + text.size() - end));
  if (error == std::errc{}) {
    if (unit == "us") return Duration{std::llround(number * 1e3)};
    if (unit == "ms") return Duration{std::llround(number * 1e6)};
    if (unit == "s") return Duration{std::llround(number * 1e9)};
  }
  throw std::runtime_error("not a time: " + text);
}

}  // namespace fieldcast::test
