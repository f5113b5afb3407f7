#include "bridge/dds/result_sender.hpp"

#include <algorithm>
#include <utility>

namespace fieldcast {

namespace {

// RTPS 2.2, 9.3.1.5: a participant's identity begins with its vendor. Readers of Fast DDS keep what comes before the first
// heartbeat.
bool is_fast_dds(const ResultSender::GuidPrefix& participant) {
  const auto& vendor = eprosima::fastrtps::rtps::c_VendorId_eProsima;
  return participant.value[0] == vendor[0] && participant.value[1] == vendor[1];
}

}  // namespace

ResultSender::ResultSender(Domain& domain, const std::string& label, std::function<UtcMapping()> clock,
                           std::function<void(std::string)> on_problem)
    : domain_(domain), clock_(std::move(clock)), on_problem_(std::move(on_problem)) {
  writer_ = domain.writer<idl::CommandResultPubSubType>(kCommandResultTopic, result_writer_qos(), label, this,
                                                        dds::StatusMask::publication_matched());
  once_.attach(writer_);
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
  const Instant settled = std::max(requester.heard, match->second.since) + kSettle;
  return settled > now ? std::optional(settled) : std::nullopt;
}

void ResultSender::send(const idl::CommandResult& result) {
  std::unique_lock lock(mutex_);
  if (const auto requester = requesters_.find(result.requester().c_str()); requester != requesters_.end()) {
    if (const auto until = hold_until(requester->second, clock_().instant)) {
      held_.push_back({requester->second.participant, *until, result});
      if (held_.size() > kMaxHeld) held_.front().until = Instant{};
      changed_.notify_one();
      return;
    }
  }
  if (ready_.empty() && !sending_) {
    lock.unlock();
    const bool sent = once_.write(const_cast<idl::CommandResult&>(result));  // the library wants it so; it only reads
    lock.lock();
    if (sent) {
      if (std::exchange(settled_, false)) changed_.notify_one();
      return;
    }
  }
  enqueue(result, lock);
}

void ResultSender::enqueue(const idl::CommandResult& result, std::unique_lock<std::mutex>& lock) {
  if (ready_.size() < kMaxReady) {
    ready_.push_back(result);
    changed_.notify_one();
    return;
  }
  lock.unlock();
  on_problem_("result " + std::to_string(result.request_id()) + " of " + result.requester().c_str() +
              " was not sent: readers do not acknowledge");
}

void ResultSender::on_publication_matched(dds::DataWriter*, const dds::PublicationMatchedStatus& status) {
  const GuidPrefix participant = eprosima::fastrtps::rtps::iHandle2GUID(status.last_subscription_handle).guidPrefix;
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
    if (held.participant == participant) held.until = is_fast_dds(participant) ? now : now + kSettle;
  }
  changed_.notify_one();
}

void ResultSender::take_due() {
  const Instant now = clock_().instant;
  std::erase_if(held_, [&](Held& held) {
    if (held.until > now) return false;
    ready_.push_back(std::move(held.result));
    return true;
  });
}

void ResultSender::run() {
  std::unique_lock lock(mutex_);
  while (!closing_) {
    take_due();
    if (!ready_.empty()) {
      idl::CommandResult next = std::move(ready_.front());
      ready_.pop_front();
      sending_ = true;
      lock.unlock();
      const bool sent = once_.write(next) || (once_.make_room(kWaitForRoom), once_.write(next));
      lock.lock();
      sending_ = false;
      settled_ = false;
      if (!sent) ready_.push_front(std::move(next));
      continue;
    }
    std::optional<Instant> until;
    for (const Held& held : held_) until = std::min(until.value_or(held.until), held.until);
    if (!settled_) until = std::min(until.value_or(Instant::max()), clock_().instant + kWaitForRoom);
    if (!until) {
      changed_.wait(lock);
      continue;
    }
    changed_.wait_for(lock, *until - clock_().instant);
    if (settled_) continue;
    settled_ = true;
    lock.unlock();
    const bool settled = once_.settle();
    lock.lock();
    settled_ = settled_ && settled;  // not if something was sent meanwhile
  }
}

void ResultSender::close(Duration linger) {
  {
    const std::lock_guard lock(mutex_);
    closing_ = true;
    changed_.notify_one();
  }
  thread_.join();
  std::deque<idl::CommandResult> last;
  {
    const std::lock_guard lock(mutex_);
    for (Held& held : held_) ready_.push_back(std::move(held.result));
    held_.clear();
    last.swap(ready_);
  }
  bool waited = false;  // once for all: the bridge is on its way out
  for (idl::CommandResult& result : last) {
    if (once_.write(result) || std::exchange(waited, true)) continue;
    once_.make_room(linger);
    (void)once_.write(result);
  }
  writer_->wait_for_acknowledgments(to_dds(linger));
  domain_.remove(std::exchange(writer_, nullptr));
}

}  // namespace fieldcast
