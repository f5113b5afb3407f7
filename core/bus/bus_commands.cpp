// Commands: checked before the wire, one at a time on it, each ended by exactly one result.
#include <algorithm>

#include "core/bus/bus_state.hpp"

namespace fieldcast {
namespace {

CommandResult refusal(const Command& command, CommandState state, Cause cause, std::string reason,
                      Instant now) {
  return {
      command.requester, command.request_id, state, cause, 0, std::move(reason), {}, now, now, now};
}

}  // namespace

void BusEngine::State::accept(const Command& command, Instant now, Actions& actions) {
  const auto reject = [&](Cause cause, std::string reason) {
    const CommandState state =
        cause == Cause::kExpired ? CommandState::kExpired : CommandState::kRejected;
    actions.push_back(Complete{refusal(command, state, cause, std::move(reason), now)});
  };
  const auto found = device_names.find(command.device);
  if (found == device_names.end())
    return reject(Cause::kUnknownDevice,
                  "bus '" + spec.name + "' has no device '" + command.device + "'");
  if (const auto fault = refuse(command, found->second, now))
    return reject(fault->cause, fault->reason);
  const DeviceRuntime& device = devices[found->second];
  auto job = CommandJob::make(command, *device.spec, found->second,
                              channels.first_of(found->second), *device.protocol, codec);
  if (!job) return reject(job.error().cause, job.error().reason);
  if (const auto channel = job->written_channel()) {
    const Duration interval = channels.spec(*channel).write_interval;
    if (interval > Duration::zero() && last_write[*channel] != kLongAgo &&
        now < last_write[*channel] + interval)
      return reject(Cause::kRateLimited,
                    "written less than " + to_text(interval) + " ago (write: interval)");
    last_write[*channel] = now;
  }
  commands.push_back({std::move(*job), now});
}

// What holds for every command, whatever it asks.
std::optional<CommandFault> BusEngine::State::refuse(const Command& command, DeviceIndex device,
                                                     Instant now) const {
  if (command.expires <= now)
    return CommandFault{Cause::kExpired, std::string(to_text(Cause::kExpired))};
  switch (bus_state) {
    case BusState::kStopped:
      return CommandFault{Cause::kShutdown, std::string(to_text(Cause::kShutdown))};
    case BusState::kLeased:
      return CommandFault{Cause::kLeased, std::string(to_text(Cause::kLeased))};
    case BusState::kOpening:
    case BusState::kClosed:
      return CommandFault{Cause::kOffline, "port of bus '" + spec.name + "' is down"};
    case BusState::kRunning: break;
  }
  if (devices[device].health.offline())
    return CommandFault{Cause::kOffline, "device '" + command.device + "' does not answer"};
  if (commands.size() >= kMaxCommands)
    return CommandFault{Cause::kQueueFull,
                        std::to_string(kMaxCommands) + " commands are waiting already"};
  return std::nullopt;
}

// The first command whose device may be asked now; it stays the first of the queue until it is
// finished.
std::optional<BusEngine::State::Flight> BusEngine::State::next_command(Instant now) {
  if (!job_active) {
    const auto ready = std::find_if(commands.begin(), commands.end(), [&](const PendingCommand& c) {
      return command_from(c.job) <= now;
    });
    if (ready == commands.end()) return std::nullopt;
    std::rotate(commands.begin(), ready, ready + 1);
    job_active = true;
  }
  CommandJob& job = commands.front().job;
  const DeviceRuntime& device = devices[job.device()];
  if (command_from(job) > now) return std::nullopt;
  job.start(now);
  if (driver.echo() == Echo::kUnknown && device.protocol->traits().echo_is_ambiguous) {
    job.use_distinct_answers();
    if (!is_distinct(job.device(), *job.next())) job.read_first();
  }
  Flight next;
  next.kind = Flight::Kind::kCommand;
  next.device = job.device();
  next.request = *job.next();
  if (auto write = job.batchable()) {
    next.batch = gather(*write);
    for (std::size_t i = 0; i < next.batch; ++i) commands[i].job.start(now);
    next.request = std::move(*write);
  }
  return next;
}

// When the next request of a command may go out: after its device's rest, and when no answer that
// is owed could be taken for its own; not even one to the same read, which was asked before.
Instant BusEngine::State::command_from(const CommandJob& job) const {
  Flight next;
  next.kind = Flight::Kind::kCommand;
  next.device = job.device();
  Instant from = devices[next.device].paused_until;
  if (owed.empty()) return from;
  if (auto request = job.next()) {
    next.request = std::move(*request);
    from = std::max(from, askable_from(next));
  }
  return from;
}

// Writes that wait behind the first one for the same device and continue its range, on either side,
// travel with it: they are moved to the front. The order of a device's commands stays: the first of
// them that does not fit ends the search.
std::size_t BusEngine::State::gather(WriteRequest& write) {
  const DeviceIndex device = commands.front().job.device();
  const Protocol& protocol = *devices[device].protocol;
  std::size_t batch = 1;
  for (std::size_t i = 1; i < commands.size() && batch < kMaxBatch; ++i) {
    if (commands[i].job.device() != device) continue;
    const auto other = commands[i].job.batchable();
    if (!other || other->range.area != write.range.area) break;
    const bool after = other->range.first == write.range.end();
    if (!after && other->range.end() != write.range.first) break;
    WriteRequest both = write;
    both.range = {write.range.area, std::min(write.range.first, other->range.first),
                  write.range.count + other->range.count};
    both.items.insert(after ? both.items.end() : both.items.begin(), other->items.begin(),
                      other->items.end());
    both.distinct_answer = write.distinct_answer || other->distinct_answer;
    if (!protocol.size(both)) break;
    write = std::move(both);
    const auto at = commands.begin() + static_cast<std::ptrdiff_t>(i);
    std::rotate(commands.begin() + static_cast<std::ptrdiff_t>(batch), at, at + 1);
    ++batch;
  }
  return batch;
}

void BusEngine::State::command_done(std::size_t batch, const Reply& reply, Instant now,
                                    Actions& actions) {
  for (std::size_t i = 0; i < batch; ++i) commands[i].job.answered(reply);
  finish_commands(batch, now, actions);
}

void BusEngine::State::command_failed(std::size_t batch, Cause cause, std::uint16_t code,
                                      Instant now, Actions& actions) {
  const bool refused =
      cause == Cause::kDeviceError || cause == Cause::kDeviceBusy || cause == Cause::kUnsupported;
  for (std::size_t i = 0; i < batch; ++i) {
    if (batch > 1 && refused)
      commands[i].job.go_alone();
    else
      commands[i].job.failed(cause, code);
  }
  finish_commands(batch, now, actions);
}

// What the last request brought to its end leaves the queue; the others have more exchanges to
// come.
void BusEngine::State::finish_commands(std::size_t batch, Instant now, Actions& actions) {
  std::size_t at = 0;
  for (; batch > 0; --batch) {
    if (commands[at].job.next()) {
      ++at;
      continue;
    }
    complete(commands[at], now, actions);
    commands.erase(commands.begin() + static_cast<std::ptrdiff_t>(at));
  }
  job_active = at > 0;
}

void BusEngine::State::complete(const PendingCommand& done, Instant now, Actions& actions) {
  std::vector<Sample> out;
  for (const CommandJob::Acquired& read : done.job.acquired())
    channels.acquired(read.channel, read.item_bits, read.items, driver.answered(), out);
  samples += out.size();
  ++commands_done;
  actions.push_back(Complete{done.job.result(done.received, now)});
  if (!out.empty()) actions.push_back(Publish{std::move(out)});
}

void BusEngine::State::expire_commands(Instant now, Actions& actions) {
  if (next_command_expiry() > now) return;
  // What has begun is never called back.
  const auto expired = std::stable_partition(
      commands.begin(), commands.end(),
      [&](const PendingCommand& c) { return c.job.started() || c.job.command().expires > now; });
  for (auto c = expired; c != commands.end(); ++c) {
    CommandResult result = refusal(c->job.command(), CommandState::kExpired, Cause::kExpired,
                                   std::string(to_text(Cause::kExpired)), now);
    result.received = c->received;
    actions.push_back(Complete{std::move(result)});
  }
  commands.erase(expired, commands.end());
}

Instant BusEngine::State::next_command_expiry() const {
  Instant next = kNever;
  for (const PendingCommand& c : commands) {
    if (!c.job.started()) next = std::min(next, c.job.command().expires);
  }
  return next;
}

void BusEngine::State::refuse_all_commands(CommandState state, Cause cause,
                                           const std::string& reason, Instant now,
                                           Actions& actions) {
  for (const PendingCommand& waiting : commands) {
    CommandResult result = refusal(waiting.job.command(), state, cause, reason, now);
    result.received = waiting.received;
    if (waiting.job.started()) {
      result.state = CommandState::kFailed;
      result.reason += "; unknown whether it took effect";
    }
    actions.push_back(Complete{std::move(result)});
  }
  commands.clear();
  job_active = false;
}

}  // namespace fieldcast
