#include <algorithm>

#include "tests/campaign/group_day.hpp"

namespace fieldcast::test {
namespace {

using namespace std::chrono_literals;

// Two masters that detected the same silence may begin together; one must stop within this time.
constexpr Duration kBeginning = 2s;
// Longest time with two masters: one or two messages, which may be lost, end it. It occurs after a
// pause of one master, which listens first.
constexpr Duration kTwoMasters = 500ms;
// Longest takeover: the lease, the silence of the wire, the first good value.
constexpr Duration kTakeover = 8s;
// While a bridge can serve, a channel is good within this time and some of its refreshes.
constexpr Duration kMustBeGood = 25s;
constexpr Duration kResultWithin = 40s;

}  // namespace

// Returns true if the network was partitioned at any time since `when`.
bool GroupDay::was_cut_since(Instant when) const { return network_->is_cut() || healed_ >= when; }

void GroupDay::see_frame(Instant start, int sender, ByteView bytes) {
  const auto characters = static_cast<std::int64_t>(bytes.size());
  const Duration silence = start - std::min(start, wire_until_);
  if (transcribing_)
    note((sender < 0 ? std::string("<< ")
                     : members_[static_cast<std::size_t>(sender)]->name() + " >> ") +
         to_hex(bytes));
  if (sender >= 0) {
    if (silence >= times_.claim) busy_since_ = start;
    const bool beginning = start - busy_since_ < kBeginning;
    if (last_master_ >= 0 && last_master_ != sender) {
      other_until_ = wire_until_;
      if (silence < times_.listen && !beginning)
        violate("a master began " + to_text(silence) + " after another one");
    }
    last_master_ = sender;
  }
  // The counter includes the previous frame, but not yet this one.
  const std::uint64_t garbled = wire_->counts().garbled;
  const bool two = start - other_until_ < kBeginning;  // else it was a late response
  if (garbled > garbled_ && two && start - busy_since_ >= kBeginning)
    violate("a frame was garbled");
  garbled_ = garbled;
  wire_until_ = std::max(wire_until_, start + line_of(spec_.port).characters(1) * characters);
}

void GroupDay::see_action(std::size_t index, const Action& action) {
  if (violation_) return;
  GroupMember& member = *members_[index];
  const auto* publish = std::get_if<Publish>(&action);
  if (publish != nullptr && transcribing_) {
    for (const Sample& sample : publish->samples)
      note(member.name() + " sample " + std::to_string(sample.channel) + " #" +
           std::to_string(sample.sequence) + " = " + to_text(sample.value) + " " +
           std::string(to_text(sample.quality)));
  }
  member.on_action(action, now());
}

// Checks values when their block is sent.
void GroupDay::judge_values(const GroupBlock& block) {
  if (block.again) return;
  for (const Sample& sample : block.samples) {
    if (sample.quality != Quality::kGood) continue;
    ++counts_.good;
    const bool wrong = sabotage_ == GroupSabotage::kValue && counts_.good == 500;
    if (const auto what = memory_.wrong(sample.channel,
                                        wrong ? Value{std::string{"wrong"}} : sample.value, now()))
      violate(*what);
  }
}

void GroupDay::see_block(const GroupBlock& block) {
  if (transcribing_) {
    std::string text = "station: " + std::to_string(block.samples.size()) + " samples of term " +
                       std::to_string(number_of(block.term)) + (block.again ? " again" : "");
    for (const Sample& sample : block.samples)
      text += " " + std::to_string(sample.channel) + "#" + std::to_string(sample.sequence);
    note(text);
  }
  for (const Sample& sample : block.samples) see_sample(block, sample);
  if (sabotage_ != GroupSabotage::kOldSample || block.again) return;
  if (!before_ || before_->began == block.began) {
    before_ = block;
    return;
  }
  GroupBlock late = block;
  late.began = std::exchange(before_, block)->began;
  for (Sample& sample : late.samples) {
    sample.sequence += 1'000'000;
    see_sample(late, sample);
  }
}

void GroupDay::see_sample(const GroupBlock& block, const Sample& sample) {
  Channel& channel = channels_[sample.channel];
  if (sabotage_ == GroupSabotage::kSilence && sample.channel == 0 && now() - Instant{} > 5min)
    return;
  // A catalogue exists as long as a bridge serves it.
  const bool gone = std::ranges::none_of(
      members_, [&](const auto& member) { return member->epoch() == channel.epoch; });
  if (block.epoch < channel.epoch && !gone) return;
  if (block.epoch != channel.epoch) {
    channel.epoch = block.epoch;
    channel.sequence = 0;
    channel.below = 0;
    channel.master_began = {};  // a new catalogue has no previous samples
  }
  const std::string text = "channel " + std::to_string(sample.channel);
  // During a partition both sides had a master; the higher number is valid.
  const bool cut = was_cut_since(std::max(block.began, channel.master_began) - 2s);
  channel.below = sample.sequence < channel.sequence   ? channel.below + 1
                  : sample.sequence > channel.sequence ? 0
                                                       : channel.below;
  if (sample.sequence <= channel.sequence) {
    const bool overtaken = block.began < std::max(channel.master_began, channel.again_began);
    if (!block.again && !overtaken && !cut)
      violate(text + " does not count on: " + std::to_string(sample.sequence) + " after " +
              std::to_string(channel.sequence));
    return;
  }
  if (block.began < channel.master_began && !cut)
    violate(text + " has a sample of an old master after one of the new");
  ++counts_.samples;
  channel.sequence = sample.sequence;
  // Repeated values may be those of the previous master and may arrive before its own samples.
  (block.again ? channel.again_began : channel.master_began) = block.began;
  channel.published = now();
  channel.shown_good = sample.quality == Quality::kGood;
  if (channel.shown_good) channel.last_good = now();
}

void GroupDay::see_result(const CommandResult& result) {
  if (transcribing_)
    note("result " + std::to_string(result.request_id) + " " + std::string(to_text(result.state)) +
         " " + result.reason);
  const auto found = pending_.find(result.request_id);
  if (found == pending_.end()) return;
  if (sabotage_ == GroupSabotage::kNoResult && result.request_id % 50 == 0) return;
  found->second.results.push_back(result);
  if (sabotage_ == GroupSabotage::kTwoResults && result.request_id % 50 == 0)
    found->second.results.push_back(result);
}

// Called after kResultWithin. A partition excuses all violations but wrong values and wrong writes.
void GroupDay::judge_results(std::uint64_t id, const Pending& pending) {
  const std::string text = "command " + std::to_string(id);
  const bool cut = was_cut_since(pending.sent - 1s);
  // Results that may arrive in addition: the bridge that ran the command has ended, or the command
  // reached a master whose process had been paused.
  const auto is_beside = [](const CommandResult& result) {
    return (result.state == CommandState::kFailed && result.cause == Cause::kShutdown) ||
           (result.state == CommandState::kRejected && result.cause == Cause::kOffline);
  };
  if (pending.results.empty()) {
    const bool somebody = std::ranges::any_of(members_, [&](const auto& member) {
      return member->alive() && member->fit_since() <= pending.sent;
    });
    if (somebody && !cut) violate(text + " has no result");
  } else {
    ++counts_.results;
  }
  if (!pending.written) return;
  Writes& writes = writes_[channels_[pending.channel].device];
  if (cut) ++writes.excused;
  if (pending.results.empty()) return;
  if (pending.results.size() > 1) {
    const auto others = std::ranges::count_if(pending.results, std::not_fn(is_beside));
    if (others > 1 && !cut) violate(text + " has " + std::to_string(others) + " results");
    ++counts_.second_results;
  }
  const bool refused = std::ranges::all_of(pending.results, [](const CommandResult& result) {
    return result.state == CommandState::kRejected || result.state == CommandState::kExpired;
  });
  writes.refused += refused;
}

// One of two masters must receive the other's messages and step back.
void GroupDay::judge_masters() {
  const auto masters = std::ranges::count_if(
      members_, [this](const auto& member) { return member->may_send(now()); });
  if (masters < 2 || was_cut_since(now() - 1s)) {
    two_since_ = kNever;
    return;
  }
  two_since_ = std::min(two_since_, now());
  if (now() - two_since_ > kTwoMasters)
    violate("two are master for " + to_text(now() - two_since_));
}

// No device has executed more writes than were sent, without refused ones.
void GroupDay::judge_writes() {
  std::vector<std::uint64_t> excused(writes_.size());
  for (const auto& [id, pending] : pending_)
    excused[channels_[pending.channel].device] += was_cut_since(pending.sent - 1s);
  for (std::size_t d = 0; d < writes_.size(); ++d) {
    const std::uint64_t executed = wire_->device(d).statistics().write_requests;
    const Writes& writes = writes_[d];
    if (executed > writes.sent - writes.refused + writes.excused + excused[d])
      violate(spec_.devices[d].name + " has executed " + std::to_string(executed) + " writes of " +
              std::to_string(writes.sent) + ", of which " + std::to_string(writes.refused) +
              " were refused");
  }
}

void GroupDay::sweep() {
  for (auto each = pending_.begin(); each != pending_.end();) {
    if (now() - each->second.sent <= kResultWithin) break;
    judge_results(each->first, each->second);
    each = pending_.erase(each);
  }
  judge_writes();
  // A paused process cannot serve, and listens first when it continues.
  const bool somebody = std::ranges::any_of(members_, [&](const auto& member) {
    return member->alive() && member->fit_since() != kNever && now() - member->fit_since() > 5s &&
           now() >= member->stopped_until() + 1s;
  });
  if (network_->is_cut() || !somebody) served_since_ = now();
  Instant promoted = kLongAgo;  // a new master may use each refresh once more
  for (const auto& member : members_) promoted = std::max(promoted, member->promoted());
  for (std::size_t c = 0; c < channels_.size(); ++c) {
    const Channel& channel = channels_[c];
    const std::string text = "channel " + std::to_string(c);
    const Duration silent = now() - std::max({channel.published, served_since_, promoted});
    if (channel.shown_good && silent > channel.gap + kTakeover)
      return violate(text + " is shown good, and silent for " + to_text(silent));
    if (now() - std::max(channel.last_good, served_since_) > kMustBeGood + 5 * channel.gap)
      return violate(text + " is not read, although a bridge could serve");
  }
}

void GroupDay::note(const std::string& text) {
  if (!transcribing_ || (violation_ && !text.starts_with("VIOLATION"))) return;
  transcript_.push_back(to_text(now() - Instant{}) + "  " + text);
  if (transcript_.size() > kTranscriptLines) transcript_.pop_front();
}

void GroupDay::violate(const std::string& what) {
  if (violation_) return;
  ++counts_.violations;
  violation_ = what + ", at " + to_text(now() - Instant{});
  note("VIOLATION: " + what);
}

}  // namespace fieldcast::test
