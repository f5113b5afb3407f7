#include "tools/cli/command/command_run.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <ostream>

#include "tools/cli/clock.hpp"
#include "tools/cli/view/json.hpp"

namespace fieldcast::cli {
namespace {

struct Waiting {
  std::size_t errand = 0;
  Instant until{};
};

}  // namespace

CommandRun::CommandRun(DomainView& domain, const Connection& connection, Options options,
                       std::ostream& out, std::ostream& err)
    : domain_(domain), connection_(connection), options_(options), out_(out), err_(err) {
  domain_.subscribe_results();
  domain_.subscribe_channels();
  domain_.subscribe_status();
}

Errand channel_write(const ChannelPath& path, Value value, WriteDetails details) {
  Errand errand;
  errand.command.bus = path.bus;
  auto& command = errand.command.command;
  command.device = path.device;
  command.target = ChannelTarget{path.channel};
  command.operation = Operation::kWrite;
  command.values = {value};
  command.verify = details.verify;
  errand.outcome.bus = path.bus;
  errand.outcome.device = path.device;
  errand.outcome.target = path.channel;
  errand.outcome.write = true;
  errand.outcome.wanted = {std::move(value)};
  errand.outcome.type = std::move(details.type);
  errand.outcome.unit = std::move(details.unit);
  return errand;
}

Errand unknown_bus(ChannelPath path, const std::string& at, bool write,
                   const Catalogue& catalogue) {
  auto reason = catalogue.explain_unknown(path);
  path.channel = at;
  return {{}, refused_here(path, write, Cause::kUnknownDevice, std::move(reason))};
}

bool CommandRun::learn(const std::vector<ChannelPath>& paths, Wanted wanted) {
  const auto known = [&](const ChannelPath& path) {
    if (wanted == Wanted::kDevice) return catalogue_.has_device(path.bus, path.device);
    return !path.channel.empty() && catalogue_.find(path) != nullptr;
  };
  const auto began = instant_now();
  auto last_news = began;
  while (!domain_.inbox().closed()) {
    if (std::all_of(paths.begin(), paths.end(), known)) return true;
    const auto now = instant_now();
    if (!catalogue_.empty() && now - last_news >= kQuietTime) return true;
    if (now - began >= kBridgeWait) break;
    const auto until = catalogue_.empty() ? began + kBridgeWait
                                          : std::min(began + kBridgeWait, last_news + kQuietTime);
    for (const auto& event : domain_.inbox().take_all(to_steady(until))) {
      if (note(event)) last_news = instant_now();
    }
  }
  if (!catalogue_.empty() && !domain_.interrupted()) return true;
  err_ << "fieldcast: "
       << (domain_.interrupted() ? "interrupted"
                                 : no_bridge_text(connection_, domain_.missing_servers()))
       << '\n';
  return false;
}

// True for something new.
bool CommandRun::note(const DomainEvent& event) {
  if (const auto* channel = std::get_if<StationChannel>(&event)) {
    catalogue_.add(*channel);
    return true;
  }
  // The catalogue has no rows for a device without channels, but its status tells of it.
  const auto* device = std::get_if<StationDeviceStatus>(&event);
  return device != nullptr && catalogue_.add_device(device->bus, device->device);
}

ExitCode CommandRun::why_not() const {
  return domain_.interrupted() ? ExitCode::kInterrupted : ExitCode::kNoBridge;
}

bool CommandRun::send(Errand& errand) {
  errand.command.lifespan = options_.timeout;
  // Waits are short, so that Ctrl-C does not wait for a bridge that takes no commands.
  constexpr Duration kShortWait = std::chrono::milliseconds{100};
  auto& outcome = errand.outcome;
  for (const auto until = instant_now() + kBridgeWait; !domain_.interrupted();) {
    const auto sent = domain_.station().send(errand.command, kShortWait);
    if (sent) {
      outcome.result.request_id = *sent;
      return true;
    }
    if (sent.error() == StationFault::kNoBridge && instant_now() < until) continue;
    outcome.state = sent.error() == StationFault::kNoBridge ? Outcome::State::kNoResult
                                                            : Outcome::State::kNotSent;
    outcome.result.reason = sent.error() == StationFault::kNoBridge
                                ? not_served_text(connection_, errand.command.bus)
                                : std::string(to_text(sent.error()));
    return false;
  }
  outcome.state = Outcome::State::kNotSent;
  outcome.result.reason = "interrupted";
  return false;
}

ExitCode CommandRun::execute(std::vector<Errand> errands) {
  auto worst = ExitCode::kOk;
  const auto finish = [&](Errand& errand) {
    print(errand.outcome);
    worst = std::max(worst, exit_code_of(errand.outcome));
  };

  std::map<std::uint64_t, Waiting> waiting;
  std::size_t next = 0;
  while (next < errands.size() || !waiting.empty()) {
    for (; next < errands.size() && waiting.size() < kAtATime; ++next) {
      auto& errand = errands[next];
      if (errand.to_be_sent() && send(errand)) {
        waiting[errand.outcome.result.request_id] = {
            next, instant_now() + options_.timeout + kResultGrace};
      } else {
        finish(errand);
      }
    }
    if (waiting.empty()) continue;

    const auto soonest = std::min_element(
        waiting.begin(), waiting.end(),
        [](const auto& a, const auto& b) { return a.second.until < b.second.until; });
    for (const auto& event : domain_.inbox().take_all(to_steady(soonest->second.until))) {
      const auto* result = std::get_if<StationResult>(&event);
      const auto found = result == nullptr ? waiting.end() : waiting.find(result->request_id);
      if (found == waiting.end()) continue;
      errands[found->second.errand].outcome.result = *result;
      finish(errands[found->second.errand]);
      waiting.erase(found);
    }
    for (auto entry = waiting.begin(); entry != waiting.end();) {
      if (entry->second.until > instant_now() && !domain_.interrupted()) {
        ++entry;
        continue;
      }
      auto& outcome = errands[entry->second.errand].outcome;
      outcome.state = Outcome::State::kNoResult;
      outcome.result.reason =
          domain_.interrupted()
              ? "interrupted; whether it was executed is not known"
              : fmt::format("no result within {}; whether it was executed is not known{}",
                            to_text(options_.timeout + kResultGrace),
                            held_remark(connection_, errands[entry->second.errand].command.bus));
      finish(errands[entry->second.errand]);
      entry = waiting.erase(entry);
    }
  }
  out_.flush();
  return domain_.interrupted() ? ExitCode::kInterrupted : worst;
}

void CommandRun::print(const Outcome& outcome) {
  if (options_.json) {
    out_ << to_line(outcome_json(outcome)) << '\n' << std::flush;
  } else {
    (exit_code_of(outcome) == ExitCode::kOk ? out_ : err_) << outcome_line(outcome) << '\n'
                                                           << std::flush;
  }
}

}  // namespace fieldcast::cli
