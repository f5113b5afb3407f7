// The checks of BusDay: at each action of its engine, and at each sweep.
#include <algorithm>

#include "tests/campaign/bus_day.hpp"

namespace fieldcast::test {
namespace {

using namespace std::chrono_literals;

// A channel without a fault is good within this time and some of its refreshes. The time includes
// the longest failure of a device, which is recorded when it ends.
constexpr Duration kChannelMustBeGood = 8min;
constexpr Duration kTellTolerance = 10ms;
// A late response and the next one may arrive in one read of the port. The times of a channel
// increase, so its second sample is a nanosecond later (ChannelTable::acquired).
constexpr Duration kSameInstant = 10ns;
constexpr Duration kResultWithin = 30s;  // after a command was sent

}  // namespace

// Checks that do not depend on an action.
void BusDay::sweep() {
  for (const auto& [id, pending] : pending_) {
    if (now() - pending.sent > kResultWithin)
      return violate("command " + std::to_string(id) + " has no result");
  }
  for (std::size_t c = 0; c < channels_.size(); ++c) {
    const Channel& channel = channels_[c];
    if (channel.shown_good && channel.gap &&
        now() - channel.published > *channel.gap + kTellTolerance)
      return violate("channel " + std::to_string(c) + " is shown good, and silent for " +
                     to_text(now() - channel.published));
    const Instant undisturbed =
        std::max({channel.last_good, channel.promised, disturbed_, dead_until_[channel.device]});
    if (channel.gap && now() - undisturbed > kChannelMustBeGood + 5 * *channel.gap)
      return violate("channel " + std::to_string(c) + " is not read, although nothing hinders it");
  }
}

void BusDay::see(const Action& action) {
  if (!busy_ || violation_) return;
  if (const auto* send = std::get_if<Send>(&action)) see_send(*send);
  if (const auto* publish = std::get_if<Publish>(&action)) {
    for (const Sample& sample : publish->samples) see_sample(sample);
  }
  if (const auto* promise = std::get_if<Promise>(&action)) {
    Channel& channel = channels_[promise->channel];
    channel.gap = promise->gap;
    channel.published = channel.promised = now();
  }
  if (const auto* complete = std::get_if<Complete>(&action)) {
    if (sabotage_ == Sabotage::kNoResult && counts_.results > 20) return;
    see_result(complete->result);
    if (sabotage_ == Sabotage::kTwoResults && counts_.results > 20) see_result(complete->result);
  }
  if (const auto* timer = std::get_if<SetTimer>(&action); timer && timer->at < now())
    violate("a timer in the past");
  if (!transcribing_) return;
  if (const auto* notice = std::get_if<Notice>(&action))
    note("notice " + notice->device + " " + notice->text);
  if (const auto* reopen = std::get_if<Reopen>(&action)) note("reopen " + reopen->reason);
}

void BusDay::see_send(const Send& send) {
  ++counts_.requests;
  if (transcribing_) note(">> " + to_hex(send.bytes));
  if (!bus_->plugged()) return violate("a request was sent into a closed port");
  if (leased_) return violate("a request was sent into a leased port");
  if (now() < wire_free_) return violate("a request was sent into the one before");
  const auto characters = static_cast<std::int64_t>(send.bytes.size());
  wire_free_ = now() + line_of(variants_[variant_].port).characters(1) * characters;
  if (sabotage_ == Sabotage::kOverlap && counts_.requests == 1000) see_send(send);
}

void BusDay::see_sample(const Sample& sample) {
  ++counts_.samples;
  Channel& channel = channels_[sample.channel];
  if (transcribing_)
    note("sample " + std::to_string(sample.channel) + " = " + to_text(sample.value) + " " +
         std::string(to_text(sample.quality)));
  if (sabotage_ == Sabotage::kSilence && sample.channel == 0 && now() - Instant{} > 1h) return;
  if (channel.shown_good && channel.gap &&
      now() - channel.published > *channel.gap + kTellTolerance)
    violate("channel " + std::to_string(sample.channel) + " was good, and silent for " +
            to_text(now() - channel.published));
  channel.published = now();
  channel.shown_good = sample.quality == Quality::kGood;
  if (!channel.shown_good) return;
  ++counts_.good;
  channel.last_good = now();
  if (sample.acquired > now() + kSameInstant) violate("acquired in the future");
  if (sample.acquired <= channel.acquired) violate("acquired no later than the sample before");
  channel.acquired = sample.acquired;
  const bool wrong = sabotage_ == Sabotage::kValue && counts_.good == 1000;
  judge(sample.channel, wrong ? Value{std::string{"wrong"}} : sample.value);
}

void BusDay::see_result(const CommandResult& result) {
  const auto found = pending_.find(result.request_id);
  if (transcribing_)
    note("result " + std::to_string(result.request_id) + " " + std::string(to_text(result.state)) +
         " " + result.reason);
  if (found == pending_.end())
    return violate("a second result for command " + std::to_string(result.request_id));
  ++counts_.results;
  const Pending pending = std::move(found->second);
  pending_.erase(found);
  judge_done(pending, result);
}

void BusDay::judge(ChannelIndex channel, const Value& value) {
  if (const auto wrong = memory_.wrong(channel, value, now())) violate(*wrong);
}

// A write reported as done was executed, and a value that was read is the device's value.
void BusDay::judge_done(const Pending& pending, const CommandResult& result) {
  if (pending.written) memory_.look(pending.channel, now());
  const bool done = result.state == CommandState::kDone || result.state == CommandState::kVerified;
  if (!done) return;
  ++counts_.done;
  for (const Value& value : result.values) judge(pending.channel, value);
  const bool restarted =
      restarted_ > 0 && Instant{} + restarts_[restarted_ - 1].first >= pending.sent;
  if (pending.written && memory_.holds(pending.channel) != *pending.written && !restarted)
    violate("command " + std::to_string(result.request_id) + " is done, but the device holds " +
            to_text(memory_.holds(pending.channel)) + " instead of " + to_text(*pending.written));
}

}  // namespace fieldcast::test
