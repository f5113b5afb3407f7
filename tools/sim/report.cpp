#include "tools/sim/report.hpp"

#include <cstdio>
#include <fstream>

#include "core/base/json.hpp"

namespace fieldcast::sim {
namespace {

Json device_report(const SimBus::Member& member) {
  const DeviceStatistics& counted = member.device->statistics();
  Json exceptions = Json::object();
  for (const auto& [code, count] : counted.exceptions) exceptions.add(std::to_string(code), count);
  std::uint64_t requests = 0;
  for (const auto& [function, count] : counted.requests) requests += count;
  return {{"name", member.name},
          {"requests", requests},
          {"requests_by_function", counted.requests},
          {"answers", counted.answers},
          {"exceptions", exceptions},
          {"write_requests", counted.write_requests},
          {"writes", counted.writes},
          {"broadcasts", counted.broadcasts},
          {"bad_frames", counted.bad_frames},
          {"unheard_characters", member.missed},
          {"spoiled_answers", member.spoiled}};
}

Json bus_report(const SimBus& bus) {
  const LineStatistics& line = bus.statistics();
  Json devices = Json::array();
  for (const SimBus::Member& member : bus.members()) devices.push_back(device_report(member));
  std::optional<double> rest_us;
  if (line.shortest_rest) rest_us = static_cast<double>(line.shortest_rest->count()) / 1000.0;
  return {{"name", bus.spec().name},
          {"port", to_text(bus.spec().port)},
          {"bytes_heard", line.bytes_received},
          {"bytes_said", line.bytes_sent},
          {"lost_characters", line.lost},
          {"collisions", line.collisions},
          {"connections", line.connections},
          {"shortest_rest_us", rest_us},
          {"devices", devices}};
}

}  // namespace

std::string location_line(const BusSpec& bus, const std::string& location) {
  const Json line{{"bus", bus.name},
                  {"place", location},
                  {"port", to_text(bus.port)},
                  {"devices", bus.devices.size()}};
  return line.text();
}

std::string report_of(std::span<const std::unique_ptr<SimBus>> buses, Duration running) {
  Json list = Json::array();
  for (const auto& bus : buses) list.push_back(bus_report(*bus));
  return Json{{"seconds", to_seconds(running)}, {"buses", list}}.text() + "\n";
}

bool write_report(const std::string& path, const std::string& report) {
  const std::string draft = path + ".part";
  {
    std::ofstream file(draft, std::ios::trunc);
    file << report;
    file.flush();
    if (!file) return false;
  }
  return std::rename(draft.c_str(), path.c_str()) == 0;
}

}  // namespace fieldcast::sim
