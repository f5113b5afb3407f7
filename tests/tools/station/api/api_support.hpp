// A table of routes without a server: the waiting test runs the work that is posted to the io
// thread.
//
// Runs on the thread of the test; post() may be called from any thread.
#pragma once

#include <gtest/gtest.h>
#include <zlib.h>

#include <condition_variable>
#include <deque>
#include <mutex>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>

#include "bridge/store/store.hpp"
#include "tests/bridge/store/scratch.hpp"
#include "tests/bridge/store/store_support.hpp"
#include "tools/station/api/base/database.hpp"
#include "tools/station/web/route_table.hpp"

namespace fieldcast::web::test {

using Json = nlohmann::ordered_json;
using fieldcast::test::forever;
using fieldcast::test::Scratch;
using fieldcast::test::utc;

class FakeIo {
 public:
  [[nodiscard]] PostToIo post() {
    return [this](std::function<void()> task) {
      const std::lock_guard lock(mutex_);
      tasks_.push_back(std::move(task));
      arrived_.notify_one();
    };
  }
  // Runs posted work until `done` returns true. Returns false after 30 s.
  [[nodiscard]] bool run_until(const std::function<bool()>& done) {
    const auto end = std::chrono::steady_clock::now() + std::chrono::seconds{30};
    while (!done()) {
      std::unique_lock lock(mutex_);
      if (!arrived_.wait_until(lock, end, [this] { return !tasks_.empty(); })) return false;
      const auto task = std::move(tasks_.front());
      tasks_.pop_front();
      lock.unlock();
      task();
    }
    return true;
  }

 private:
  std::mutex mutex_;
  std::condition_variable arrived_;
  std::deque<std::function<void()>> tasks_;
};

inline HttpRequest request_of(const std::string& target, Method method = Method::kGet) {
  auto parsed = parse_target(target);
  HttpRequest request;
  request.method = method;
  if (!parsed) {
    ADD_FAILURE() << "no target: " << target;
    return request;
  }
  request.path = parsed->path;
  request.query = parsed->query;
  return request;
}

inline std::string unzipped(const std::string& bytes) {
  z_stream stream{};
  EXPECT_EQ(::inflateInit2(&stream, 15 + 16), Z_OK);
  stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(bytes.data()));
  stream.avail_in = static_cast<uInt>(bytes.size());
  std::string text;
  int done = Z_OK;
  while (done == Z_OK) {
    char part[4096];
    stream.next_out = reinterpret_cast<Bytef*>(part);
    stream.avail_out = sizeof part;
    done = ::inflate(&stream, Z_NO_FLUSH);
    text.append(part, sizeof part - stream.avail_out);
  }
  EXPECT_EQ(done, Z_STREAM_END);
  ::inflateEnd(&stream);
  return text;
}

class ApiTest : public testing::Test {
 protected:
  static constexpr std::int64_t kNow = 100'000;  // seconds of utc()
  [[nodiscard]] static std::function<UtcTime()> now() {
    return [] { return utc(kNow); };
  }

  [[nodiscard]] StoreAddress address() const { return StoreAddress(scratch_.path("api.db")); }
  void store(const std::function<void(Store&)>& fill) {
    (void)open_store(address(), IfMissing::kCreate);  // a store without content creates no file
    Store store(forever(address()));
    fill(store);
    EXPECT_TRUE(store.flush(std::chrono::seconds{30}));
  }
  [[nodiscard]] Database* database() {
    if (!database_) database_.emplace(address(), io_.post());
    return &*database_;
  }
  [[nodiscard]] HttpResponse ask(const HttpRequest& request, Role role = Role::kEngineer,
                                 const std::string& user = "anna") {
    const auto route = table_.find(request.method, request.path, role);
    if (!route) return route.error();
    std::optional<HttpResponse> response;
    (*route)->handler(request, Caller{user, role, "127.0.0.1"},
                      [&](HttpResponse given) { response = std::move(given); });
    EXPECT_TRUE(io_.run_until([&] { return response.has_value(); })) << "no response";
    return response.value_or(HttpResponse{});
  }
  [[nodiscard]] HttpResponse ask(const std::string& target) { return ask(request_of(target)); }
  [[nodiscard]] Json json(const std::string& target) {
    const HttpResponse response = ask(target);
    EXPECT_EQ(response.status, 200u) << response.body;
    return Json::parse(response.body, nullptr, false);
  }
  [[nodiscard]] std::pair<std::string, int> all_of(const HttpResponse& response) {
    std::string body;
    int pieces = 0;
    for (bool ended = false; !ended;) {
      std::optional<Piece> piece;
      response.next([&](Piece given) { piece = std::move(given); });
      if (!io_.run_until([&] { return piece.has_value(); })) {
        ADD_FAILURE() << "no piece";
        return {body, pieces};
      }
      ended = !*piece;
      if (ended) break;
      EXPECT_FALSE((*piece)->empty()) << "an empty piece would end a chunked body";
      body += **piece;
      ++pieces;
    }
    return {body, pieces};
  }

  Scratch scratch_;
  FakeIo io_;
  std::optional<Database> database_;
  RouteTable table_;
};

}  // namespace fieldcast::web::test
