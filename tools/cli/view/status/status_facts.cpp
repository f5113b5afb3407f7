#include "tools/cli/view/status/status_facts.hpp"

#include <fmt/format.h>

#include "tools/cli/view/status/status_words.hpp"

namespace fieldcast::cli {
namespace {

std::string joined(const std::vector<std::string>& addresses) {
  std::string text;
  for (const auto& at : addresses) text += (text.empty() ? "" : " ") + at;
  return text;
}

std::string times(std::uint64_t count, std::string_view one, std::string_view many) {
  return fmt::format("{} {}", count, count == 1 ? one : many);
}

std::string misses_text(std::uint64_t count, const CauseCounts& misses) {
  if (count == 0) return "none";
  return misses.empty() ? std::to_string(count) : fmt::format("{}: {}", count, causes_text(misses));
}

std::string area_text(const AreaReport& area) {
  std::string text = fmt::format("{}: responds in {}, blocks to {} items so far", area.area,
                                 milliseconds_text(area.answer_time), area.largest_block);
  if (area.longest_block != 0) text += fmt::format("; it accepts {} at most", area.longest_block);
  return text;
}

}  // namespace

std::string percent_text(double share) { return fmt::format("{:.1f} %", share * 100); }

std::string milliseconds_text(Duration time) {
  return time == Duration{} ? "-" : fmt::format("{:.2f} ms", to_seconds(time) * 1e3);
}

std::string causes_text(const CauseCounts& causes) {
  std::string text;
  for (const auto& [name, count] : causes)
    text += fmt::format("{}{} {}", text.empty() ? "" : ", ", name, count);
  return text;
}

Tone tone_of(BusState state) {
  return state == BusState::kRunning  ? Tone::kGood
         : state == BusState::kClosed ? Tone::kBad
                                      : Tone::kWarning;
}

Tone tone_of(DeviceState state) {
  switch (state) {
    case DeviceState::kOnline: return Tone::kGood;
    case DeviceState::kOffline: return Tone::kBad;
    default: return Tone::kWarning;
  }
}

std::vector<StatusFact> bus_facts(const StationBusStatus& bus) {
  const BusReport& report = bus.report;
  const bool much = report.planned_load > 0.9 || report.stretch > 1;
  std::vector<StatusFact> facts{
      {"state", bus_words(bus), report.stretch > 1 ? Tone::kBad : tone_of(report.state)},
      {"wire",
       fmt::format("busy {} of the last second; planned {}, reading {}",
                   percent_text(report.utilisation), percent_text(report.planned_load),
                   percent_text(report.measured_load)),
       much ? Tone::kWarning : Tone::kPlain},
      {"so far", fmt::format("{}, {}, {}, port opened again {}",
                             times(report.exchanges, "exchange", "exchanges"),
                             times(report.samples, "sample", "samples"),
                             times(report.commands, "command", "commands"),
                             times(report.reopened, "time", "times"))},
      {"missed", "refreshes: " + misses_text(report.deadline_misses, bus.misses),
       report.deadline_misses == 0 ? Tone::kPlain : Tone::kWarning},
  };
  if (!bus.causes.empty())
    facts.push_back({"failures", "exchanges: " + causes_text(bus.causes), Tone::kWarning});
  if (bus.clock_ahead && !clocks_agree(*bus.clock_ahead))
    facts.push_back({"clock", clock_words(bus.bridge, *bus.clock_ahead), Tone::kWarning});
  return facts;
}

std::vector<StatusFact> device_facts(const StationDeviceStatus& device,
                                     const StationBusStatus* bus) {
  const DeviceReport& report = device.report;
  std::vector<StatusFact> facts{
      {"state", device_words(device, bus), tone_of(report.state)},
      {"times",
       fmt::format("responds in {}, spread {}; timeout {}; pause after responses {}",
                   milliseconds_text(report.answer_time), milliseconds_text(report.answer_spread),
                   milliseconds_text(report.timeout), milliseconds_text(report.pause))},
      {"so far",
       fmt::format("{}, {} failed, {} tried again; {} missed",
                   times(report.exchanges, "exchange", "exchanges"), report.failures,
                   report.retries, times(report.deadline_misses, "refresh", "refreshes"))},
  };
  if (!device.causes.empty())
    facts.push_back({"failures", causes_text(device.causes), Tone::kWarning});
  for (const AreaReport& area : report.areas) facts.push_back({"area", area_text(area)});
  if (!report.refused.empty())
    facts.push_back({"refused",
                     "addresses, which are left out of blocks: " + joined(report.refused),
                     Tone::kWarning});
  if (!report.refused_gaps.empty())
    facts.push_back({"gaps",
                     "unused addresses between channels that it refuses to read, so that no block "
                     "runs across them: " +
                         joined(report.refused_gaps),
                     Tone::kWarning});
  return facts;
}

}  // namespace fieldcast::cli
