#include "tools/cli/command/base/command_run.hpp"

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
                       const Streams& to)
    : domain_(domain), connection_(connection), options_(options), to_(to) {
  domain_.subscribe_results();
  domain_.subscribe_channels();
  domain_.subscribe_status();
}

Errand errand_for(const ChannelPath& path, Operation operation, Target target,
                  const std::string& named) {
  Errand errand;
  errand.command.bus = path.bus;
  errand.command.command.device = path.device;
  errand.command.command.target = std::move(target);
  errand.command.command.operation = operation;
  errand.outcome.bus = path.bus;
  errand.outcome.device = path.device;
  errand.outcome.target = named;
  errand.outcome.write = operation == Operation::kWrite;
  return errand;
}

Errand channel_write(const ChannelPath& path, Value value, WriteDetails details) {
  Errand errand = errand_for(path, Operation::kWrite, ChannelTarget{path.channel}, path.channel);
  errand.command.command.values = {value};
  errand.command.command.verify = details.verify;
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
  to_.err << "fieldcast: "
          << (domain_.interrupted() ? "interrupted"
                                    : no_bridge_text(connection_, domain_.missing_servers()))
          << '\n';
  return false;
}

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

bool CommandRun::send(Errand& errand, Duration lifespan) {
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
  const bool was_unserved = unserved_.erase(errand.command.bus) > 0;
  const auto until = instant_now() + (was_unserved ? Duration::zero() : kBridgeWait);
  while (!domain_.interrupted()) {
    const auto sent = domain_.station().send(errand.command, kShortWait);
    if (sent) {
      outcome.result.request_id = *sent;
      return true;
    }
    if (sent.error() == StationFault::kNoBridge && instant_now() < until) continue;
    const bool unserved = sent.error() == StationFault::kNoBridge;
    if (unserved) unserved_.insert(errand.command.bus);
    outcome.state = unserved || sent.error() == StationFault::kNotTaken ? Outcome::State::kNoResult
                                                                        : Outcome::State::kNotSent;
    outcome.result.reason = unserved ? not_served_text(connection_, errand.command.bus)
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
      if (errand.to_be_sent() && send(errand, options_.timeout)) {
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
              : no_result_text(connection_, errands[entry->second.errand].command.bus,
                               options_.timeout + kResultGrace);
      finish(errands[entry->second.errand]);
      entry = waiting.erase(entry);
    }
  }
  to_.out.flush();
  return domain_.interrupted() ? ExitCode::kInterrupted : worst;
}

void CommandRun::print(const Outcome& outcome) {
  if (options_.json) {
    to_.out << outcome_json(outcome).text() << '\n' << std::flush;
  } else {
    (exit_code_of(outcome) == ExitCode::kOk ? to_.out : to_.err) << outcome_line(outcome) << '\n'
                                                                 << std::flush;
  }
}

ExitCode in_domain(const ConnectionOptions& options, const Streams& to, const InDomain& command) {
  Interrupt interrupt;  // before DDS starts its threads
  const auto connection = resolve(options);
  if (connection) return command(*connection, interrupt);
  to.err << connection.error() << '\n';
  return ExitCode::kUsage;
}

Listening receive_reports(DomainView& domain, const Connection& connection,
                          std::optional<Duration> time, const Streams& to,
                          const OnReport& on_event) {
  constexpr Duration kLook = std::chrono::milliseconds{500};
  const auto began = instant_now();
  const auto end = began + time.value_or(kBridgeWait);
  Listening listening(connection, began);
  for (auto now = began; now < end && !domain.inbox().closed() && to.out; now = instant_now()) {
    if (!time && now >= listening.over_at()) break;
    const auto wake = std::min(end, time ? now + kLook : listening.over_at());
    for (const auto& event : domain.inbox().take_all(to_steady(wake))) {
      const std::string_view bus = bus_of(event);
      if (on_event(event, listening)) listening.news(bus, instant_now());
    }
    to.out.flush();
  }
  return listening;
}

std::optional<ExitCode> no_reports(std::string_view command, const DomainView& domain,
                                   const Connection& connection, const Listening& listening,
                                   bool any, std::ostream& err) {
  if (!any) {
    err << "fieldcast " << command << ": " << no_bridge_text(connection, domain.missing_servers())
        << '\n';
    return ExitCode::kNoBridge;
  }
  if (const std::string silent = listening.silent_text(); !silent.empty())
    err << "fieldcast " << command << ": " << silent << '\n';
  return std::nullopt;
}

std::optional<BridgeSpec> load_configuration(const std::string& path, std::ostream& err,
                                             const config::LoadOptions& options) {
  auto loaded = config::load_file(path, options);
  if (loaded) return *std::move(loaded);
  err << config::to_text(loaded.error()) << '\n';
  return std::nullopt;
}

ExitCode in_store(const StoreSource& source, std::ostream& err, IfMissing missing,
                  const std::function<ExitCode(SqlConnection& store)>& command) {
  const auto address = resolve(source);
  if (address) return command(*open_store(*address, missing));
  err << address.error() << '\n';
  return ExitCode::kUsage;
}

ExitCode end_of_records(const Streams& to, std::size_t records, std::string_view nothing) {
  to.out.flush();
  if (!to.out) return ExitCode::kTrouble;
  if (records > 0) return ExitCode::kOk;
  to.err << nothing << '\n';
  return ExitCode::kNothing;
}

}  // namespace fieldcast::cli
