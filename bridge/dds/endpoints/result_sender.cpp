#include "bridge/dds/endpoints/result_sender.hpp"

#include <pthread.h>

#include <algorithm>
#include <utility>

#include "bridge/dds/filter/sent_message.hpp"
#include "bridge/dds/topics/sample_type.hpp"

namespace fieldcast {

namespace {

// RTPS 2.2, 9.3.1.5: a participant's identity begins with its vendor. Readers of Fast DDS keep
// messages that arrive before the first heartbeat.
bool is_fast_dds(const ResultSender::GuidPrefix& participant) {
  const auto& vendor = rtps::c_VendorId_eProsima;
  return participant.value[0] == vendor[0] && participant.value[1] == vendor[1];
}

}  // namespace

ResultSender::ResultSender(Domain& domain, const std::string& label,
                           std::function<UtcMapping()> clock,
                           std::function<void(std::string)> on_problem)
    : domain_(domain), clock_(std::move(clock)), on_problem_(std::move(on_problem)) {
  writer_ = domain.writer<idl::CommandResultPubSubType, ResultType>(
      kCommandResultTopic, label, this, dds::StatusMask::publication_matched());
  thread_ = std::thread([this] { run(); });
}

ResultSender::~ResultSender() {
  if (writer_ != nullptr) close(Duration::zero());
}

void ResultSender::remember(const std::string& requester, const GuidPrefix& participant) {
  const std::lock_guard lock(mutex_);
  const auto known = requesters_.find(requester);
  if (known != requesters_.end() && known->second.participant == participant) return;
  if (requesters_.size() >= kMaxRequesters) requesters_.clear();
  requesters_[requester] = {participant, clock_().instant};
}

std::optional<Instant> ResultSender::hold_until(const Requester& requester, Instant now) const {
  const auto match = matched_.find(requester.participant);
  if (match == matched_.end()) return now + kHold;
  if (is_fast_dds(requester.participant)) return std::nullopt;
  const Instant settled = std::max(requester.first_seen, match->second.since) + kSettle;
  return settled > now ? std::optional(settled) : std::nullopt;
}

void ResultSender::send(const idl::CommandResult& result) {
  {
    const std::lock_guard lock(mutex_);
    const auto requester = requesters_.find(result.requester().c_str());
    const auto until = requester == requesters_.end()
                           ? std::nullopt
                           : hold_until(requester->second, clock_().instant);
    if (until) {
      held_.push_back({requester->second.participant, *until, result});
      if (held_.size() > kMaxHeld) held_.front().until = Instant{};
      changed_.notify_one();
      return;
    }
  }
  write(result);
}

void ResultSender::write(const idl::CommandResult& result) {
  OutgoingResult outgoing{&result};
  if (!is_taken(writer_->write(&outgoing))) {
    return on_problem_("result " + std::to_string(result.request_id()) + " of " +
                       result.requester().c_str() + " was not sent: DDS did not take it");
  }
  const std::lock_guard lock(mutex_);
  Kept& kept = kept_.emplace_back();
  kept.keys.requester(result.requester());
  kept.keys.request_id(result.request_id());
  kept.since = clock_().instant;
  if (kept_.size() == 1 || kept_.size() > kMaxKept) changed_.notify_one();
}

void ResultSender::let_go(const idl::CommandResult& sent) {
  OutgoingResult outgoing{&sent, true};
  rtps::WriteParams how;
  how.related_sample_identity(unregister_mark(ResultType::hash_of(sent)));
  writer_->write(&outgoing, how);
}

void ResultSender::on_publication_matched(dds::DataWriter*,
                                          const dds::PublicationMatchedStatus& status) {
  const GuidPrefix participant = rtps::iHandle2GUID(status.last_subscription_handle).guidPrefix;
  const std::lock_guard lock(mutex_);
  if (status.current_count_change < 0) {
    const auto match = matched_.find(participant);
    if (match != matched_.end() && --match->second.readers == 0) matched_.erase(match);
    return;
  }
  const Instant now = clock_().instant;
  Match& match = matched_[participant];
  ++match.readers;
  match.since = now;
  for (Held& held : held_) {
    if (held.participant == participant)
      held.until = is_fast_dds(participant) ? now : now + kSettle;
  }
  changed_.notify_one();
}

std::vector<idl::CommandResult> ResultSender::take_due(Instant now) {
  std::vector<idl::CommandResult> due;
  std::erase_if(held_, [&](Held& held) {
    if (held.until > now) return false;
    due.push_back(std::move(held.result));
    return true;
  });
  return due;
}

std::vector<idl::CommandResult> ResultSender::take_kept(Instant now) {
  std::vector<idl::CommandResult> over;
  while (!kept_.empty() && (kept_.size() > kMaxKept || now - kept_.front().since >= kKeep)) {
    over.push_back(std::move(kept_.front().keys));
    kept_.pop_front();
  }
  return over;
}

std::optional<Instant> ResultSender::next_due() const {
  std::optional<Instant> next;
  for (const Held& held : held_) next = std::min(next.value_or(held.until), held.until);
  if (!kept_.empty()) {
    const Instant over = kept_.front().since + kKeep;
    next = std::min(next.value_or(over), over);
  }
  return next;
}

void ResultSender::run() {
  pthread_setname_np(pthread_self(), "results");
  std::unique_lock lock(mutex_);
  while (!closing_) {
    const Instant now = clock_().instant;
    const auto due = take_due(now), over = take_kept(now);
    if (!due.empty() || !over.empty()) {
      lock.unlock();
      for (const idl::CommandResult& result : due) write(result);
      for (const idl::CommandResult& sent : over) let_go(sent);
      lock.lock();
      continue;
    }
    if (const auto next = next_due()) {
      changed_.wait_for(lock, *next - now);
    } else {
      changed_.wait(lock);
    }
  }
}

void ResultSender::close(Duration linger) {
  {
    const std::lock_guard lock(mutex_);
    closing_ = true;
    changed_.notify_one();
  }
  thread_.join();
  // The thread has ended. Remaining results are sent now; their instances end with the writer.
  for (const Held& held : std::exchange(held_, {})) write(held.result);
  writer_->wait_for_acknowledgments(to_dds(linger));
  domain_.remove(std::exchange(writer_, nullptr));
}

}  // namespace fieldcast
