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
  if (worker_.queue().try_put(task)) return;
  --waiting_;
  refuse(std::move(task));
}

void Database::refuse(Task task) {
  ++busy_;
  task.refuse(DatabaseFault::kBusy);
}

void Database::respond(Responder read, Reply reply) {
  query<HttpResponse>(std::move(read), [reply = std::move(reply)](auto result) {
    reply(result ? *std::move(result) : response_of(result.error()));
  });
}

void Database::run(BoundedQueue<Task>& queue) {
  while (!queue.closed()) {
    if (auto task = queue.take()) serve(*std::move(task));
  }
  for (Task& task : queue.take_present()) task.refuse(DatabaseFault::kAway);
}

void Database::serve(Task task) {
  try {
    if (!connection_) {
      connection_ = open_store(address_, IfMissing::kFail);
      make_read_only(*connection_);
    }
    connection_->limit(std::chrono::steady_clock::now() + kLongest);
    task.run(*connection_);
  } catch (const StoreTooSlow& error) {
    ++too_slow_;
    fail(task, DatabaseFault::kTooSlow, error.what());
  } catch (const StoreError& error) {
    ++away_;
    connection_.reset();
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
