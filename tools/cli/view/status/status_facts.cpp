#include "tools/cli/view/status/status_facts.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "tools/cli/model/sample_text.hpp"
#include "tools/cli/view/status/status_words.hpp"

namespace fieldcast::cli {

Tone tone_of(const StandbyMessage& member) {
  if (member.member.role == StandbyRole::kMaster) return Tone::kGood;
  return member.member.not_ready.empty() ? Tone::kFaint : Tone::kWarning;
}

const StandbyMessage* master_of(const StandbyModel& model, const std::string& group) {
  const StandbyMessage* found = nullptr;
  for (const auto& [key, member] : model) {
    if (key.first != group) continue;
    const StandbyRole role = member.member.role;
    if (role != StandbyRole::kMaster && role != StandbyRole::kHandingOver) continue;
    if (found == nullptr || member.member.term > found->member.term) found = &member;
  }
  return found;
}

std::uint64_t behind(const StandbyModel& model, const StandbyMessage& member) {
  const StandbyMessage* const master = master_of(model, member.group);
  if (master == nullptr || master == &member) return 0;
  std::uint64_t blocks = 0;
  for (const StandbyBusFigures& theirs : master->buses) {
    const auto own = std::ranges::find(member.buses, theirs.bus, &StandbyBusFigures::bus);
    if (own != member.buses.end() && own->epoch == theirs.epoch && own->blocks < theirs.blocks)
      blocks += theirs.blocks - own->blocks;
  }
  return blocks;
}

std::vector<std::string> standby_lines(const StandbyModel& model, const Screen& screen) {
  if (model.empty()) return {"no bridge belongs to a standby group"};
  TextTable table({{"group"},
                   {"bridge"},
                   {"role"},
                   {"strength", Align::kRight},
                   {"term", Align::kRight},
                   {"behind", Align::kRight},
                   {"host"},
                   {"not ready"}});
  for (const auto& [key, member] : model) {
    table.add_row({{key.first},
                   {key.second},
                   {std::string(to_text(member.member.role)), tone_of(member)},
                   {std::to_string(member.member.strength)},
                   {std::to_string(number_of(member.member.term))},
                   {std::to_string(behind(model, member))},
                   {member.host, Tone::kFaint},
                   {member.member.not_ready, Tone::kWarning}});
  }
  return table.render(screen);
}

Json standby_json(const StandbyMessage& message) {
  const StandbyMember& member = message.member;
  return {{"topic", "Standby"},
          {"group", message.group},
          {"bridge", member.bridge},
          {"host", message.host},
          {"role", to_text(member.role)},
          {"strength", member.strength},
          {"term", number_of(member.term)},
          {"not_ready", member.not_ready}};
}

namespace {

std::string times(std::uint64_t count, std::string_view one, std::string_view many) {
  return fmt::format("{} {}", count, count == 1 ? one : many);
}

std::string misses_text(std::uint64_t count, const CauseCounts& misses) {
  if (count == 0) return "none";
  return misses.empty() ? std::to_string(count) : fmt::format("{}: {}", count, causes_text(misses));
}

std::string area_text(const AreaReport& area) {
  std::string text = fmt::format("{}: responds in {}, blocks to {} items so far", area.area,
                                 milliseconds_text(area.response_time), area.largest_block);
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
      {"times", fmt::format("responds in {}, spread {}; timeout {}; pause after responses {}",
                            milliseconds_text(report.response_time),
                            milliseconds_text(report.response_spread),
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
    facts.push_back(
        {"refused",
         fmt::format("addresses, which are left out of blocks: {}", fmt::join(report.refused, " ")),
         Tone::kWarning});
  if (!report.refused_gaps.empty())
    facts.push_back({"gaps",
                     fmt::format("unused addresses between channels that it refuses to read, so "
                                 "that no block runs across them: {}",
                                 fmt::join(report.refused_gaps, " ")),
                     Tone::kWarning});
  return facts;
}

namespace {

std::string member_words(const StandbyMessage& message) {
  const StandbyMember& member = message.member;
  switch (member.role) {
    case StandbyRole::kMaster: return "master: it serves the buses and runs commands";
    case StandbyRole::kHandingOver: return "master, and hands over to " + member.successor;
    case StandbyRole::kReleased: return "it has handed over to " + member.successor;
    case StandbyRole::kLeft: return "it has left the group";
    case StandbyRole::kWaiting: break;
  }
  return member.not_ready.empty() ? "waiting: it takes over when no master is there"
                                  : "not ready, it does not take over: " + member.not_ready;
}

}  // namespace

std::string role_text(const StandbyMessage& member) {
  const bool waits = member.member.role == StandbyRole::kWaiting;
  if (waits && !member.member.not_ready.empty()) return "not ready";
  return std::string(to_text(member.member.role));
}

std::vector<StatusFact> group_facts(const StandbyModel& model, const std::string& group) {
  std::size_t members = 0, ready = 0;
  for (const auto& [key, member] : model) {
    if (key.first != group) continue;
    ++members;
    ready += member.member.role == StandbyRole::kWaiting && member.member.not_ready.empty() ? 1 : 0;
  }
  const StandbyMessage* const master = master_of(model, group);
  std::vector<StatusFact> facts;
  if (master == nullptr) {
    facts.push_back({"state", "no master: nobody serves the buses of the group", Tone::kBad});
  } else {
    facts.push_back({"state",
                     fmt::format("{} is master, term {}", master->member.bridge,
                                 number_of(master->member.term)),
                     Tone::kGood});
  }
  facts.push_back({"members",
                   fmt::format("{}, and {} of them would take over", members,
                               ready == 0 ? std::string("none") : std::to_string(ready)),
                   ready == 0 ? Tone::kWarning : Tone::kPlain});
  return facts;
}

std::vector<StatusFact> member_facts(const StandbyModel& model, const StandbyMessage& message) {
  const std::uint64_t blocks = behind(model, message);
  std::vector<StatusFact> facts{{"state", member_words(message), tone_of(message)}};
  if (message.member.role == StandbyRole::kWaiting)
    facts.push_back({"behind", fmt::format("{} blocks of the master not followed yet", blocks)});
  facts.push_back(
      {"strength", fmt::format("{}; of those that are ready the strongest takes over, then the one "
                               "whose name comes first",
                               message.member.strength)});
  facts.push_back({"host", message.host});
  return facts;
}

}  // namespace fieldcast::cli
