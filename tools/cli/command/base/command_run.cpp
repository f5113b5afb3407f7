#include "tools/cli/command/base/command_run.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <ostream>

#include "core/base/json.hpp"
#include "tools/cli/domain/domain_view.hpp"
#include "tools/cli/terminal/interrupt.hpp"

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
  Listening listening(connection_, began);
  // Latest time at which the path may still be announced.
  const auto until = [&](const ChannelPath& path) {
    if (!listening.heard_site_of(path.bus)) return began + kBridgeWait;
    return listening.last_news() + (catalogue_.has_bus(path.bus) ? kQuietTime : kOtherBridges);
  };
  while (!domain_.inbox().closed()) {
    Instant wait = kLongAgo;
    for (const ChannelPath& path : paths) {
      if (!known(path)) wait = std::max(wait, until(path));
    }
    if (instant_now() >= wait) break;
    for (const auto& event : domain_.inbox().take_all(to_steady(wait))) {
      if (const auto bus = note(event)) listening.news(*bus, instant_now());
    }
  }
  for (std::string& site : listening.silent_sites()) catalogue_.add_silent_site(std::move(site));
  if (!catalogue_.empty() && !domain_.interrupted()) return true;
  err_ << "fieldcast: "
       << (domain_.interrupted() ? "interrupted"
                                 : no_bridge_text(connection_, domain_.missing_servers()))
       << '\n';
  return false;
}

// Returns the bus if the event is new.
std::optional<std::string> CommandRun::note(const DomainEvent& event) {
  if (const auto* channel = std::get_if<StationChannel>(&event)) {
    const bool is_new =
        catalogue_.find({channel->bus, channel->device, channel->channel}) == nullptr;
    catalogue_.add(*channel);
    return is_new ? std::optional(channel->bus) : std::nullopt;
  }
  // A device without channels is known only by its status.
  const auto* device = std::get_if<StationDeviceStatus>(&event);
  const bool is_new = device != nullptr && catalogue_.add_device(device->bus, device->device);
  return is_new ? std::optional(device->bus) : std::nullopt;
}

ExitCode CommandRun::why_not() const {
  return domain_.interrupted() ? ExitCode::kInterrupted : ExitCode::kNoBridge;
}

bool CommandRun::send(Errand& errand, Duration lifespan, Duration wait) {
  errand.command.lifespan = lifespan;
  // Short waits, so that Ctrl-C works while a bridge accepts no commands.
  constexpr Duration kShortWait = std::chrono::milliseconds{100};
  auto& outcome = errand.outcome;
  // DDS Security would drop the command without a notice on either side.
  if (const std::string held = held_remark(connection_, errand.command.bus); !held.empty()) {
    outcome.state = Outcome::State::kRefusedHere;
    outcome.result.state = CommandState::kRejected;
    outcome.result.cause = to_name(Cause::kReadOnly);
    outcome.result.reason = held.substr(2);  // skips "; "
    return false;
  }
  for (const auto until = instant_now() + wait; !domain_.interrupted();) {
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
      if (errand.to_be_sent() && send(errand, options_.timeout, kBridgeWait)) {
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
      Errand& errand = errands[found->second.errand];
      waiting.erase(found);
      errand.outcome.result = *result;
      finish(errand);
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
    out_ << outcome_json(outcome).text() << '\n' << std::flush;
  } else {
    (exit_code_of(outcome) == ExitCode::kOk ? out_ : err_) << outcome_line(outcome) << '\n'
                                                           << std::flush;
  }
}

ExitCode in_domain(const ConnectionOptions& options, const Streams& streams,
                   const DomainCommand& command) {
  Interrupt interrupt;  // before DDS starts its threads
  const auto connection = resolve(options);
  if (!connection) {
    streams.err << connection.error() << '\n';
    return ExitCode::kUsage;
  }
  return command(*connection, interrupt);
}

}  // namespace fieldcast::cli
