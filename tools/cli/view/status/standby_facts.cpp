#include "tools/cli/view/status/standby_facts.hpp"

#include <fmt/format.h>

#include "tools/cli/model/sample_text.hpp"

namespace fieldcast::cli {
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
