// Questions to the store, asked from the io thread and answered there. One thread of its own with
// one connection, which can change nothing, serves them one after the other.
//
// At most kMaxWaiting questions wait; one more is refused as busy. A question has kLongest. The
// store is opened for the first question and again after a failure; it need not be there yet. What
// went wrong stands in the log; who asked is told no detail.
#pragma once

#include <atomic>
#include <functional>
#include <memory>
#include <tl/expected.hpp>

#include "bridge/base/worker.hpp"
#include "bridge/store/sql.hpp"
#include "core/base/time.hpp"
#include "tools/station/web/http_message.hpp"

namespace fieldcast::web {

enum class DatabaseFault : std::uint8_t {
  kBusy,     // too many questions wait
  kTooSlow,  // the answer takes longer than kLongest
  kAway,     // the store cannot be opened, or it is broken
};
[[nodiscard]] HttpResponse response_of(DatabaseFault fault);

// How to run something on the io thread.
using PostToIo = std::function<void(std::function<void()>)>;

class Database {
 public:
  static constexpr std::size_t kMaxWaiting = 64;
  static constexpr Duration kLongest = std::chrono::seconds{10};

  Database(StoreAddress address, PostToIo post);
  ~Database();  // answers who still waits with kAway
  Database(const Database&) = delete;
  Database& operator=(const Database&) = delete;

  // `question` runs on the thread of the database and may throw StoreError. `done` is called on the
  // io thread, once.
  template <class Answer>
  using Done = std::function<void(tl::expected<Answer, DatabaseFault>)>;
  template <class Answer>
  void ask(std::function<Answer(SqlConnection&)> question, Done<Answer> done) {
    Task task = task_of(std::move(question), std::move(done));
    if (waiting_.load() >= kMaxWaiting) return refuse(std::move(task));
    put(std::move(task));
  }
  // A further question of something that began: it is never refused as busy. REQUIRES: at most one
  // for each connection of the server.
  template <class Answer>
  void ask_further(std::function<Answer(SqlConnection&)> question, Done<Answer> done) {
    put(task_of(std::move(question), std::move(done)));
  }
  // A question whose answer is a response.
  using Question = std::function<HttpResponse(SqlConnection&)>;
  void answer(Question question, Reply reply);

  struct Counters {
    std::uint64_t answered = 0;
    std::uint64_t busy = 0, too_slow = 0, away = 0;  // refused
    std::size_t waiting = 0;
  };
  [[nodiscard]] Counters counters() const;  // any thread

 private:
  struct Task {
    std::function<void(SqlConnection&)> run;  // may throw StoreError, and has posted nothing then
    std::function<void(DatabaseFault)> refuse;
  };
  template <class Answer>
  Task task_of(std::function<Answer(SqlConnection&)> question, Done<Answer> done) {
    auto shared = std::make_shared<Done<Answer>>(std::move(done));
    return {[this, question = std::move(question), shared](SqlConnection& connection) {
              auto answer = std::make_shared<Answer>(question(connection));
              ++answered_;
              post_([shared, answer] { (*shared)(std::move(*answer)); });
            },
            [this, shared](DatabaseFault fault) {
              post_([shared, fault] { (*shared)(tl::make_unexpected(fault)); });
            }};
  }
  void put(Task task);
  void refuse(Task task);
  void run(BoundedQueue<Task>& queue);
  void serve(Task task);
  void fail(Task& task, DatabaseFault fault, const char* reason);

  // More than ask() lets in: what ask_further() adds.
  static constexpr std::size_t kQueue = 4096;

  const StoreAddress address_;
  const PostToIo post_;
  std::unique_ptr<SqlConnection> connection_;  // on the thread; null: not open
  std::atomic<std::size_t> waiting_{0};
  std::atomic<std::uint64_t> answered_{0}, busy_{0}, too_slow_{0}, away_{0};
  Worker<Task> worker_;  // last: it uses what is above
};

}  // namespace fieldcast::web
