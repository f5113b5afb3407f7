#include "bridge/store/command_identities.hpp"

#include <pthread.h>

#include <utility>

#include "bridge/bus/clock.hpp"
#include "bridge/log/log.hpp"

namespace fieldcast {
namespace {

constexpr Duration kPause = std::chrono::milliseconds{100};  // between two tries of one batch
constexpr std::size_t kRemoveAfter = 1000;                   // entries, then
constexpr std::int64_t kRemoveAtOnce = 2000;                 // of the oldest are looked at

}  // namespace

CommandIdentities::CommandIdentities(const StoreAddress& address)
    : address_(address), thread_([this] { run(); }) {}

CommandIdentities::~CommandIdentities() { close(); }

void CommandIdentities::close() {
  {
    const std::lock_guard lock(mutex_);
    ending_ = true;
  }
  work_.notify_one();
  if (thread_.joinable()) thread_.join();
}

void CommandIdentities::enter(std::string requester, std::uint64_t request_id, Done done) {
  {
    const std::lock_guard lock(mutex_);
    if (!ending_ && waiting_.size() < kMaxWaiting) {
      waiting_.push_back({std::move(requester), request_id, std::move(done)});
      work_.notify_one();
      return;
    }
  }
  done(Verdict::kNotKept);
}

void CommandIdentities::run() {
  pthread_setname_np(pthread_self(), "identities");
  std::unique_lock lock(mutex_);
  while (true) {
    work_.wait(lock, [this] { return ending_ || !waiting_.empty(); });
    if (waiting_.empty()) return;
    const std::deque<Entry> batch = std::exchange(waiting_, {});
    lock.unlock();
    const std::vector<Verdict> verdicts = keep(batch);
    for (std::size_t i = 0; i < batch.size(); ++i) batch[i].done(verdicts[i]);
    lock.lock();
  }
}

// Tries for a while, unless the end is near.
std::vector<CommandIdentities::Verdict> CommandIdentities::keep(const std::deque<Entry>& batch) {
  const Instant until = steady_now() + kPatience;
  while (true) {
    try {
      return commit(batch);
    } catch (const StoreError& error) {
      connection_.reset();
      std::unique_lock lock(mutex_);
      if (ending_ || steady_now() >= until) {
        log_error("store", std::string("commands are refused, as the store does not keep them: ") +
                               error.what());
        return std::vector(batch.size(), Verdict::kNotKept);
      }
      work_.wait_for(lock, kPause, [this] { return ending_; });
    }
  }
}

void CommandIdentities::open() {
  connection_ = open_store(address_, IfMissing::kCreate);
  // Longer than a batch of samples takes, and short enough for the end of the process.
  if (connection_->dialect() == SqlConnection::Dialect::kSqlite)
    connection_->script("pragma busy_timeout = 1000");
}

std::vector<CommandIdentities::Verdict> CommandIdentities::commit(const std::deque<Entry>& batch) {
  if (!connection_) open();
  std::vector<Verdict> verdicts;
  const std::int64_t now = read_clocks().utc.nanoseconds;
  SqlTransaction transaction(*connection_);
  for (const Entry& entry : batch) {
    const std::uint64_t added = connection_->execute(
        "insert into commands (requester, request_id, taken_at) values ($1, $2, $3) "
        "on conflict (requester, request_id) do nothing",
        SqlRow{entry.requester, static_cast<std::int64_t>(entry.request_id), now});
    verdicts.push_back(added == 1 ? Verdict::kNew : Verdict::kKnown);
  }
  since_removal_ += batch.size();
  if (since_removal_ >= kRemoveAfter) remove_old();
  transaction.commit();
  return verdicts;
}

// More are looked at than were added since, so that the table comes back to its bounds.
void CommandIdentities::remove_old() {
  since_removal_ = 0;
  connection_->execute(
      "delete from commands where (requester, request_id) in "
      "(select requester, request_id from commands where taken_at < $1 order by taken_at limit $2)",
      SqlRow{read_clocks().utc.nanoseconds - kKept.count(), kRemoveAtOnce});
  std::int64_t count = 0;
  connection_->query("select count(*) from commands", {}, [&](const SqlRow& row) {
    count = integer_at(row, 0);
    return false;
  });
  if (count <= kMaxKept) return;
  connection_->execute(
      "delete from commands where (requester, request_id) in "
      "(select requester, request_id from commands order by taken_at limit $1)",
      SqlRow{std::min(count - kMaxKept, kRemoveAtOnce)});
}

}  // namespace fieldcast
