#include "bridge/history/history_service.hpp"

#include <fmt/format.h>
#include <pthread.h>
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <utility>

#include "bridge/base/clock.hpp"
#include "bridge/history/history_reader.hpp"
#include "bridge/log/log.hpp"

namespace fieldcast {

namespace {

constexpr int kNiceness = 15;  // lower priority than the store's writer

}  // namespace

HistoryService::HistoryService(std::optional<StoreSpec> store, Uses uses)
    : store_(std::move(store)), uses_(std::move(uses)), thread_([this] { run(); }) {}

void HistoryService::close() {
  if (!thread_.joinable()) return;
  {
    const std::lock_guard lock(mutex_);
    ending_ = true;
  }
  changed_.notify_one();
  thread_.join();
}

void HistoryService::receive(HistoryRequest request, std::string fault) {
  WaitingRequest waiting{std::move(request)};
  if (!store_) {
    waiting.refusal = HistoryOutcome::kNoStore;
    waiting.reason = "this bridge has no store; configure `store` to keep samples";
  }
  if (!fault.empty()) {
    waiting.refusal = HistoryOutcome::kInvalid;
    waiting.reason = std::move(fault);
  }
  {
    const std::lock_guard lock(mutex_);
    queue_.put(std::move(waiting));
  }
  changed_.notify_one();
}

void HistoryService::run() {
  pthread_setname_np(pthread_self(), "history");
  // On Linux, this applies only to this thread.
  ::setpriority(PRIO_PROCESS, static_cast<id_t>(::gettid()), kNiceness);
  std::unique_lock lock(mutex_);
  while (!ending_) {
    auto waiting = queue_.take();
    if (!waiting) {
      const auto ready = [this] { return ending_ || !queue_.empty(); };
      if (!changed_.wait_for(lock, kIdle, ready)) connection_.reset();
      continue;
    }
    lock.unlock();
    const Instant began = steady_now();
    if (uses_.serves(waiting->request.bus)) uses_.respond(waiting->request, respond_to(*waiting));
    const Duration worked = steady_now() - began;
    lock.lock();
    changed_.wait_for(lock, std::max(worked, kLeastPause), [this] { return ending_; });
  }
}

HistoryResponse HistoryService::respond_to(const WaitingRequest& waiting) {
  if (waiting.refusal != HistoryOutcome::kRows)
    return {.outcome = waiting.refusal, .reason = waiting.reason};
  const UtcTime now = read_clocks().utc;
  if (store_->keep != Duration{} &&
      waiting.request.until.nanoseconds < now.nanoseconds - store_->keep.count()) {
    return {.outcome = HistoryOutcome::kNotKept,
            .reason = fmt::format("the store keeps samples for {}", to_text(store_->keep))};
  }
  try {
    if (!connection_) {
      connection_ = open_store(StoreAddress(store_->address), IfMissing::kFail);
      make_read_only(*connection_);
    }
    connection_->limit(std::chrono::steady_clock::now() + kLongest);
    return HistoryReader(*connection_).read(waiting.request, now);
  } catch (const StoreError& error) {
    connection_.reset();
    log_counted(LogLevel::kWarning, "history", "requests for stored samples that failed",
                error.what());
    return {.outcome = HistoryOutcome::kFailed, .reason = "the store cannot be read now"};
  }
}

}  // namespace fieldcast
