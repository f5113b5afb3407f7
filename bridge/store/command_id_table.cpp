#include "bridge/store/command_id_table.hpp"

#include <utility>

#include "bridge/base/clock.hpp"
#include "bridge/log/log.hpp"

namespace fieldcast {
namespace {

constexpr Duration kPause = std::chrono::milliseconds{100};  // between two attempts for one batch
constexpr std::size_t kRemoveAfter = 1000;    // number of entries between two removals
constexpr std::int64_t kRemoveAtOnce = 2000;  // number of the oldest entries per removal

}  // namespace

CommandIdTable::CommandIdTable(const StoreAddress& address)
    : address_(address),
      worker_("identities", kMaxWaiting, [this](BoundedQueue<Entry>& queue) { run(queue); }) {}

CommandIdTable::~CommandIdTable() { close(); }

void CommandIdTable::close() { worker_.close(); }

void CommandIdTable::enter(std::string requester, std::uint64_t request_id, Done done) {
  Entry entry{std::move(requester), request_id, std::move(done)};
  if (!worker_.queue().try_put(entry)) entry.done(Verdict::kNotKept);
}

void CommandIdTable::run(BoundedQueue<Entry>& queue) {
  while (true) {
    const std::deque<Entry> batch = queue.take_all();
    if (batch.empty()) return;
    const std::vector<Verdict> verdicts = keep(batch, queue);
    for (std::size_t i = 0; i < batch.size(); ++i) batch[i].done(verdicts[i]);
  }
}

// Retries for kPatience, or until close().
std::vector<CommandIdTable::Verdict> CommandIdTable::keep(const std::deque<Entry>& batch,
                                                          BoundedQueue<Entry>& queue) {
  const Instant until = steady_now() + kPatience;
  while (true) {
    try {
      return commit(batch);
    } catch (const StoreError& error) {
      connection_.reset();
      if (queue.closed() || steady_now() >= until) {
        log_error("store", std::string("commands are refused, as the store does not keep them: ") +
                               error.what());
        return std::vector(batch.size(), Verdict::kNotKept);
      }
      (void)queue.pause(kPause);
    }
  }
}

void CommandIdTable::open() {
  connection_ = open_store(address_, IfMissing::kCreate);
  // Longer than a batch of samples lasts, and short enough for the end of the process.
  if (connection_->dialect() == SqlConnection::Dialect::kSqlite)
    connection_->script("pragma busy_timeout = 1000");
}

std::vector<CommandIdTable::Verdict> CommandIdTable::commit(const std::deque<Entry>& batch) {
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

// Removes more entries than were added since the last removal.
void CommandIdTable::remove_old() {
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
