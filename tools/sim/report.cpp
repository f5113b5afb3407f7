#include "tools/sim/report.hpp"

#include <cstdio>
#include <fstream>
#include <nlohmann/json.hpp>

namespace fieldcast::sim {
namespace {

using Json = nlohmann::ordered_json;

Json device_report(const SimBus::Member& member) {
  const DeviceStatistics& counted = member.device->statistics();
  Json exceptions = Json::object();
  for (const auto& [code, count] : counted.exceptions) exceptions[std::to_string(code)] = count;
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
  Json report{{"name", bus.spec().name},
              {"port", to_text(bus.spec().port)},
              {"bytes_heard", line.bytes_received},
              {"bytes_said", line.bytes_sent},
              {"lost_characters", line.lost},
              {"collisions", line.collisions},
              {"connections", line.connections},
              {"shortest_rest_us", nullptr},
              {"devices", Json::array()}};
  if (line.shortest_rest)
    report["shortest_rest_us"] = static_cast<double>(line.shortest_rest->count()) / 1000.0;
  for (const SimBus::Member& member : bus.members())
    report["devices"].push_back(device_report(member));
  return report;
}

}  // namespace

std::string location_line(const BusSpec& bus, const std::string& location) {
  const Json line{{"bus", bus.name},
                  {"place", location},
                  {"port", to_text(bus.port)},
                  {"devices", bus.devices.size()}};
  return line.dump();
}

std::string report_of(std::span<const std::unique_ptr<SimBus>> buses, Duration running) {
  Json report{{"seconds", to_seconds(running)}, {"buses", Json::array()}};
  for (const auto& bus : buses) report["buses"].push_back(bus_report(*bus));
  return report.dump(2) + "\n";
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
