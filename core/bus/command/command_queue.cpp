#include "core/bus/command/command_queue.hpp"

#include <algorithm>

#include "core/model/command.hpp"

namespace fieldcast {
namespace {

CommandFault fault(Cause cause) { return {cause, std::string(to_text(cause))}; }

bool join(WriteRequest& write, const WriteRequest& other, const Protocol& protocol) {
  const bool after = other.range.first == write.range.end();
  if (!after && other.range.end() != write.range.first) return false;
  WriteRequest both = write;
  both.range = {write.range.area, std::min(write.range.first, other.range.first),
                write.range.count + other.range.count};
  both.items.insert(after ? both.items.end() : both.items.begin(), other.items.begin(),
                    other.items.end());
  both.distinct_response = write.distinct_response || other.distinct_response;
  if (!protocol.size(both)) return false;
  write = std::move(both);
  return true;
}

// Ends the rate limit of a write that does not run. A later write may have set it again.
void end_interval(std::vector<Instant>& last_write, const CommandJob& job, Instant received) {
  const auto channel = job.written_channel();
  if (channel && last_write[*channel] == received) last_write[*channel] = kLongAgo;
}

// Whether a probe or an unsolicited frame shows that the device is back. A device that is only
// written has neither: its commands are the only requests that it can respond to.
bool shows_its_return(const DeviceSpec& device) {
  return std::ranges::any_of(device.channels, [](const ChannelSpec& channel) {
    return is_requestable(channel) || channel.unsolicited;
  });
}

std::size_t bytes_of(const Command& command) {
  std::size_t bytes = sizeof(CommandJob) + command.requester.size();
  for (const Value& value : command.values) {
    bytes += sizeof(Value);
    if (const auto* text = std::get_if<std::string>(&value)) bytes += text->size();
  }
  return bytes;
}

}  // namespace

CommandQueue::CommandQueue(const BusSetup& setup, ChannelTable& channels, TextCodec& codec)
    : setup_(setup),
      channels_(channels),
      codec_(codec),
      responses_(setup.devices()),
      last_write_(channels.size(), kLongAgo) {}

void CommandQueue::accept(const Command& command, const Condition& condition, Instant now,
                          ActionSink& sink) {
  auto job = check(command, condition, now);
  std::optional<CommandFault> fault;
  if (!job) {
    fault = std::move(job.error());
  } else {
    if (const auto range = job->gateway_range()) {
      const auto* stored = responses_.find(job->device(), *range, now - command.max_age);
      if (stored != nullptr && complete_from(*stored, *job, now, now, sink)) return;
    }
    fault = make_room(command, now, sink);
  }
  if (fault) {
    const CommandState state =
        fault->cause == Cause::kExpired ? CommandState::kExpired : CommandState::kRejected;
    return sink.push(
        Complete{refusal(command, state, fault->cause, std::move(fault->reason), now, now)});
  }
  if (const auto channel = job->written_channel()) last_write_[*channel] = now;
  Owner& owner = owners_.try_emplace(command.requester, Owner{0, 0, turn_ + 1}).first->second;
  if (owner.commands++ == 0) ++turn_;
  owner.bytes += bytes_of(command);
  bytes_ += bytes_of(command);
  if (!command.in_spare_time()) ++alone_;
  waiting_.push_back({std::move(*job), now, &owner});
}

// A requester with fewer commands displaces the newest one of the requester with the most.
std::optional<CommandFault> CommandQueue::make_room(const Command& command, Instant now,
                                                    ActionSink& sink) {
  const std::size_t bytes = bytes_of(command);
  const auto known = owners_.find(command.requester);
  const Owner own = known == owners_.end() ? Owner{} : known->second;
  if (own.bytes + bytes > kMaxBytesOfRequester) {
    return CommandFault{Cause::kQueueFull, std::to_string(own.commands) +
                                               " commands of this requester are waiting already"};
  }
  while (waiting_.size() >= kMaxWaiting || bytes_ + bytes > kMaxBytes) {
    const auto newest = newest_of_most(bytes_ + bytes > kMaxBytes, own);
    if (newest == waiting_.end()) {
      return CommandFault{Cause::kQueueFull,
                          std::to_string(waiting_.size()) + " commands are waiting already"};
    }
    sink.push(Complete{refusal(newest->job.command(), CommandState::kRejected, Cause::kQueueFull,
                               "the queue is full, and this requester has the most commands in it",
                               newest->received, now)});
    end_interval(last_write_, newest->job, newest->received);
    left(*newest);
    waiting_.erase(newest);
  }
  return std::nullopt;
}

std::deque<CommandQueue::Waiting>::iterator CommandQueue::newest_of_most(bool by_bytes,
                                                                         const Owner& own) {
  const auto size = [&](const Owner& owner) { return by_bytes ? owner.bytes : owner.commands; };
  auto newest = waiting_.end();
  for (auto each = waiting_.begin(); each != waiting_.end(); ++each) {
    if (each->job.started() || size(*each->owner) <= size(own) + (by_bytes ? 0 : 1)) continue;
    if (newest == waiting_.end() || size(*each->owner) >= size(*newest->owner)) newest = each;
  }
  return newest;
}

void CommandQueue::left(const Waiting& waiting) {
  const Command& command = waiting.job.command();
  bytes_ -= bytes_of(command);
  if (!command.in_spare_time()) --alone_;
  waiting.owner->bytes -= bytes_of(command);
  if (--waiting.owner->commands == 0) owners_.erase(command.requester);
}

tl::expected<CommandJob, CommandFault> CommandQueue::check(const Command& command,
                                                           const Condition& condition,
                                                           Instant now) const {
  const auto device =
      command.ad_hoc ? setup_.find_ad_hoc(*command.ad_hoc) : setup_.find(command.device);
  if (!device)
    return tl::make_unexpected(
        CommandFault{Cause::kUnknownDevice,
                     "bus '" + setup_.spec().name + "' has no device '" + command.device + "'"});
  if (command.expires <= now) return tl::make_unexpected(fault(Cause::kExpired));
  const ChannelIndex first = command.ad_hoc ? 0 : channels_.first_of(*device);
  auto job = CommandJob::make(command, setup_.device(*device), *device, first,
                              setup_.protocol(*device), codec_);
  if (!job) return job;
  if (auto found = obstacle(*job, condition, now)) return tl::make_unexpected(std::move(*found));
  return job;
}

std::optional<CommandFault> CommandQueue::obstacle(const CommandJob& job,
                                                   const Condition& condition, Instant now) const {
  switch (condition.bus) {
    case BusState::kStopped: return fault(Cause::kShutdown);
    case BusState::kLeased: return fault(Cause::kLeased);
    case BusState::kClosed:
      return CommandFault{Cause::kOffline, "port of bus '" + setup_.spec().name + "' is down"};
    case BusState::kOpening:
    case BusState::kRunning: break;
  }
  if (condition.device_offline && shows_its_return(setup_.device(job.device())))
    return CommandFault{Cause::kOffline, "device '" + job.command().device + "' does not respond"};
  const auto channel = job.written_channel();
  if (!channel) return std::nullopt;
  const Duration interval = channels_.spec(*channel).write_interval;
  if (now < last_write_[*channel] + interval)
    return CommandFault{Cause::kRateLimited,
                        "written less than " + to_text(interval) + " ago (write: interval)"};
  return std::nullopt;
}

std::optional<CommandQueue::Next> CommandQueue::next(Instant now, const Gate& gate,
                                                     bool echo_unknown) {
  if (!begun_) {
    const auto ready = next_in_turn(now, gate);
    if (ready == waiting_.end()) return std::nullopt;
    ready->owner->turn = ++turn_;
    std::rotate(waiting_.begin(), ready, ready + 1);
    begun_ = true;
  }
  CommandJob& job = waiting_.front().job;
  if (gate(job) > now) return std::nullopt;
  job.start(now);
  if (echo_unknown && setup_.protocol(job.device()).traits().echo_is_ambiguous) {
    job.use_distinct_responses();
    if (!setup_.response_differs(job.device(), *job.next())) job.read_first();
  }
  Next next{job.device(), *job.next()};
  if (auto write = job.batchable()) {
    next.batch = gather(*write);
    for (std::size_t i = 0; i < next.batch; ++i) waiting_[i].job.start(now);
    next.request = std::move(*write);
  }
  return next;
}

// The requester that was served least recently, among those with a sendable command.
std::deque<CommandQueue::Waiting>::iterator CommandQueue::next_in_turn(Instant now,
                                                                       const Gate& gate) {
  const auto turn = [](const Waiting& waiting) {
    return std::pair(waiting.job.command().in_spare_time(), waiting.owner->turn);
  };
  auto next = waiting_.end();
  for (auto each = waiting_.begin(); each != waiting_.end(); ++each) {
    const bool earlier = next == waiting_.end() || turn(*each) < turn(*next);
    if (earlier && gate(each->job) <= now) next = each;
  }
  return next;
}

bool CommandQueue::complete_from(const DeviceResponse& response, CommandJob& job, Instant received,
                                 Instant now, ActionSink& sink) const {
  const auto range = job.gateway_range();
  if (!range || !response.contains(*range)) return false;
  const bool fresh =
      response.asked >= received || (job.command().max_age > Duration::zero() &&
                                     response.acquired >= now - job.command().max_age);
  if (!fresh) return false;
  const unsigned bits = setup_.area(job.device(), range->area).item_bits;
  job.responded({RangeReply{Cause::kNone, 0, response.items_of(*range, bits)}}, now);
  sink.push(Complete{job.result(received, now)});
  return true;
}

void CommandQueue::read(DeviceIndex device, DeviceResponse response, Instant now,
                        ActionSink& sink) {
  for (std::size_t i = begun_ ? 1 : 0; i < waiting_.size();) {
    Waiting& each = waiting_[i];
    if (each.job.device() != device ||
        !complete_from(response, each.job, each.received, now, sink)) {
      ++i;
      continue;
    }
    left(each);
    waiting_.erase(waiting_.begin() + static_cast<std::ptrdiff_t>(i));
  }
  responses_.put(device, std::move(response));
}

// Moves further writes of the device to the front that extend the range of the first one, for one
// request. Keeps the order per device: the search ends at the first command that does not fit.
std::size_t CommandQueue::gather(WriteRequest& write) {
  const DeviceIndex device = waiting_.front().job.device();
  std::size_t batch = 1;
  for (std::size_t i = 1; i < waiting_.size() && batch < kMaxBatch; ++i) {
    if (waiting_[i].job.device() != device) continue;
    const auto other = waiting_[i].job.batchable();
    if (!other || other->range.area != write.range.area) break;
    if (!join(write, *other, setup_.protocol(device))) break;
    const auto at = waiting_.begin() + static_cast<std::ptrdiff_t>(i);
    std::rotate(waiting_.begin() + static_cast<std::ptrdiff_t>(batch), at, at + 1);
    ++batch;
  }
  return batch;
}

void CommandQueue::responded(std::size_t batch, const Reply& reply, Instant acquired, Instant now,
                             ActionSink& sink) {
  for (std::size_t i = 0; i < batch; ++i) waiting_[i].job.responded(reply, now);
  finish(batch, acquired, now, sink);
}

void CommandQueue::failed(std::size_t batch, Cause cause, std::uint16_t code, Instant acquired,
                          Instant now, ActionSink& sink, std::string_view seen) {
  if (first()->operation == Operation::kWrite) written(waiting_.front().job.device());
  for (std::size_t i = 0; i < batch; ++i) {
    const bool refused = cause == Cause::kUnsupported || waiting_[i].job.refuses(cause, code);
    if (batch > 1 && refused)
      waiting_[i].job.go_alone();
    else
      waiting_[i].job.failed(cause, code, seen);
  }
  finish(batch, acquired, now, sink);
}

void CommandQueue::not_sent(std::size_t batch) {
  for (std::size_t i = 0; i < batch; ++i) waiting_[i].job.not_sent();
  begun_ = first_is_begun_write();
}

bool CommandQueue::first_is_begun_write() const {
  return waiting_.front().job.started() && first()->operation == Operation::kWrite;
}

void CommandQueue::finish(std::size_t batch, Instant acquired, Instant now, ActionSink& sink) {
  std::size_t at = 0;
  for (; batch > 0; --batch) {
    Waiting& each = waiting_[at];
    std::vector<Sample> samples;
    for (const CommandJob::Acquired& read : each.job.take_acquired())
      channels_.acquired(read.channel, read.item_bits, read.items, acquired, samples);
    if (each.job.next()) {
      sink.publish(std::move(samples));
      ++at;
      continue;
    }
    if (!each.job.command().in_spare_time()) ++done_;
    sink.push(Complete{each.job.result(each.received, now)});
    sink.publish(std::move(samples));
    left(each);
    waiting_.erase(waiting_.begin() + static_cast<std::ptrdiff_t>(at));
  }
  begun_ = at > 0 && first_is_begun_write();
}

void CommandQueue::expire(BusState bus, Instant now, ActionSink& sink) {
  if (next_expiry() > now) return;
  std::string reason(to_text(Cause::kExpired));
  if (bus == BusState::kOpening)
    reason += ": the port of bus '" + setup_.spec().name + "' was still being opened";
  const auto expired = std::stable_partition(
      waiting_.begin(), waiting_.end(),
      [&](const Waiting& each) { return each.job.started() || each.job.command().expires > now; });
  for (auto each = expired; each != waiting_.end(); ++each) {
    sink.push(Complete{refusal(each->job.command(), CommandState::kExpired, Cause::kExpired, reason,
                               each->received, now)});
    end_interval(last_write_, each->job, each->received);
    left(*each);
  }
  waiting_.erase(expired, waiting_.end());
}

Instant CommandQueue::next_expiry() const {
  Instant next = kNever;
  for (const Waiting& each : waiting_) {
    if (!each.job.started()) next = std::min(next, each.job.command().expires);
  }
  return next;
}

void CommandQueue::refuse_all(Cause cause, const std::string& reason, Instant now,
                              ActionSink& sink) {
  for (const Waiting& each : waiting_) {
    CommandResult result =
        refusal(each.job.command(), CommandState::kRejected, cause, reason, each.received, now);
    if (each.job.started()) {
      result.state = CommandState::kFailed;
      if (each.job.command().operation == Operation::kWrite)
        result.reason += "; unknown whether it took effect";
    } else {
      end_interval(last_write_, each.job, each.received);
    }
    sink.push(Complete{std::move(result)});
  }
  waiting_.clear();
  owners_.clear();
  bytes_ = 0;
  alone_ = 0;
  begun_ = false;
}

bool CommandQueue::uses(DeviceIndex device) const {
  return std::ranges::any_of(
      waiting_, [&](const Waiting& waiting) { return waiting.job.device() == device; });
}

Instant CommandQueue::sendable_from(const Gate& gate) const {
  Instant from = kNever;
  for (std::size_t i = 0; i < (begun_ ? 1 : waiting_.size()); ++i)
    from = std::min(from, gate(waiting_[i].job));
  return from;
}

}  // namespace fieldcast
