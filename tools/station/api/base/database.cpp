#include "tools/station/api/base/database.hpp"

#include "bridge/log/log.hpp"

namespace fieldcast::web {

HttpResponse response_of(DatabaseFault fault) {
  HttpResponse response;
  switch (fault) {
    case DatabaseFault::kBusy:
      response = error_response(503, "too many others ask the database", "ask again in a second");
      response.headers.emplace_back("retry-after", "1");
      break;
    case DatabaseFault::kTooSlow:
      response = error_response(503, "the query takes too long",
                                "ask for a shorter time or for fewer channels");
      break;
    case DatabaseFault::kAway:
      response = error_response(503, "the database does not respond",
                                "ask again in a minute; the station's log says what is wrong");
      response.headers.emplace_back("retry-after", "60");
      break;
  }
  return response;
}

Database::Database(StoreAddress address, PostToIo post)
    : address_(std::move(address)),
      post_(std::move(post)),
      worker_("database", kQueue, [this](BoundedQueue<Task>& queue) { run(queue); }) {}

Database::~Database() { worker_.close(); }

void Database::put(Task task) {
  ++waiting_;
  if (task.urgent ? worker_.queue().try_put_first(task) : worker_.queue().try_put(task)) return;
  --waiting_;
  refuse(task);
}

void Database::refuse(const Task& task) {
  ++busy_;
  task.refuse(DatabaseFault::kBusy);
}

namespace {

Database::Done<HttpResponse> replying(Reply reply) {
  return [reply = std::move(reply)](auto result) {
    reply(result ? *std::move(result) : response_of(result.error()));
  };
}

}  // namespace

void Database::respond(Responder read, Reply reply) {
  query<HttpResponse>(std::move(read), replying(std::move(reply)));
}

void Database::respond_changing(Responder change, Reply reply) {
  Task task = task_of<HttpResponse>(std::move(change), replying(std::move(reply)), true);
  if (waiting_.load() >= kMaxWaiting) return refuse(task);
  put(std::move(task));
}

void Database::run(BoundedQueue<Task>& queue) {
  while (!queue.closed()) {
    if (auto task = queue.take()) serve(*std::move(task));
  }
  for (Task& task : queue.take_present()) task.refuse(DatabaseFault::kAway);
}

void Database::serve(Task task) {
  std::unique_ptr<SqlConnection>& connection = task.changes ? changing_ : reading_;
  try {
    if (!connection) {
      connection = open_store(address_, IfMissing::kFail);
      if (!task.changes) make_read_only(*connection);
    }
    connection->limit(std::chrono::steady_clock::now() + kLongest);
    task.run(*connection);
  } catch (const StoreTooSlow& error) {
    ++too_slow_;
    fail(task, DatabaseFault::kTooSlow, error.what());
  } catch (const StoreError& error) {
    ++away_;
    connection.reset();
    fail(task, DatabaseFault::kAway, error.what());
  }
  --waiting_;
}

void Database::fail(Task& task, DatabaseFault fault, const char* reason) {
  log_counted(LogLevel::kError, "database", "queries without a response", reason);
  task.refuse(fault);
}

Database::Counters Database::counters() const {
  return {completed_.load(), busy_.load(), too_slow_.load(), away_.load(), waiting_.load()};
}

}  // namespace fieldcast::web
