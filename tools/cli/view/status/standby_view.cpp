#include "tools/cli/view/status/standby_view.hpp"

#include <algorithm>

#include "tools/cli/model/sample_text.hpp"

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

}  // namespace fieldcast::cli
