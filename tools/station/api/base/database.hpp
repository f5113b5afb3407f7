// Runs queries of the store on a thread of its own over one read-only connection, and the rare
// changes over a second one. Queries are posted from the io thread and their results return there.
// The first query opens the store, and so does the next one after a failure. Failures are logged;
// responses have no detail.
#pragma once

#include <atomic>
#include <functional>
#include <memory>
#include <tl/expected.hpp>

#include "bridge/base/worker.hpp"
#include "bridge/http/http_message.hpp"
#include "bridge/store/sql/sql.hpp"
#include "core/base/time.hpp"

namespace fieldcast::web {

enum class DatabaseFault : std::uint8_t {
  kBusy,
  kTooSlow,  // the query lasts longer than kLongest
  kAway,     // the store cannot be opened or is damaged
};
[[nodiscard]] HttpResponse response_of(DatabaseFault fault);

using PostToIo = std::function<void(std::function<void()>)>;

class Database {
 public:
  static constexpr std::size_t kMaxWaiting = 64;
  static constexpr Duration kLongest = std::chrono::seconds{10};

  Database(StoreAddress address, PostToIo post);
  ~Database();  // waiting queries fail with kAway
  Database(const Database&) = delete;
  Database& operator=(const Database&) = delete;

  // `read` runs on the database thread and may throw StoreError; `done` on the io thread, once.
  template <class Result>
  using Done = std::function<void(tl::expected<Result, DatabaseFault>)>;
  template <class Result>
  void query(std::function<Result(SqlConnection&)> read, Done<Result> done) {
    Task task = task_of(std::move(read), std::move(done), false);
    if (waiting_.load() >= kMaxWaiting) return refuse(task);
    put(std::move(task));
  }
  // Follow-up query; never fails with kBusy. REQUIRES: at most one for each server connection.
  template <class Result>
  void query_further(std::function<Result(SqlConnection&)> read, Done<Result> done) {
    put(task_of(std::move(read), std::move(done), false));
  }
  // Runs before all waiting queries and never fails with kBusy. For the rare queries of the station
  // itself, so that clients cannot delay them by more than kLongest.
  template <class Result>
  void query_urgent(std::function<Result(SqlConnection&)> read, Done<Result> done) {
    Task task = task_of(std::move(read), std::move(done), false);
    task.urgent = true;
    put(std::move(task));
  }
  using Responder = std::function<HttpResponse(SqlConnection&)>;
  void respond(Responder read, Reply reply);
  // As respond(), over the connection that may change the store.
  void respond_changing(Responder change, Reply reply);

  struct Counters {
    std::uint64_t completed = 0;
    std::uint64_t busy = 0, too_slow = 0, away = 0;  // failed queries
    std::size_t waiting = 0;
  };
  [[nodiscard]] Counters counters() const;  // thread-safe

 private:
  struct Task {
    std::function<void(SqlConnection&)> run;  // may throw StoreError, before it posts a result
    std::function<void(DatabaseFault)> refuse;
    bool changes = false;
    bool urgent = false;
  };
  template <class Result>
  Task task_of(std::function<Result(SqlConnection&)> read, Done<Result> done, bool changes) {
    auto shared = std::make_shared<Done<Result>>(std::move(done));
    return {[this, read = std::move(read), shared](SqlConnection& connection) {
              auto result = std::make_shared<Result>(read(connection));
              ++completed_;
              post_([shared, result] { (*shared)(std::move(*result)); });
            },
            [this, shared](DatabaseFault fault) {
              post_([shared, fault] { (*shared)(tl::make_unexpected(fault)); });
            },
            changes};
  }
  void put(Task task);
  void refuse(const Task& task);
  void run(BoundedQueue<Task>& queue);
  void serve(Task task);
  void fail(Task& task, DatabaseFault fault, const char* reason);

  // Larger than kMaxWaiting, because query_further() has no limit of its own.
  static constexpr std::size_t kQueue = 4096;

  const StoreAddress address_;
  const PostToIo post_;
  // Used on the database thread only; null: not open.
  std::unique_ptr<SqlConnection> reading_, changing_;
  std::atomic<std::size_t> waiting_{0};
  std::atomic<std::uint64_t> completed_{0}, busy_{0}, too_slow_{0}, away_{0};
  Worker<Task> worker_;  // last member: its thread uses the members above
};

}  // namespace fieldcast::web
