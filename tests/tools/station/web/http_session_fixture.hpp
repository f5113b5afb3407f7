// A site without sockets: connections are streams in memory.
#pragma once

#include <gmock/gmock.h>

#include "bridge/base/clock.hpp"
#include "bridge/http/http_session.hpp"
#include "tests/tools/station/web/memory_stream.hpp"
#include "tools/station/web/station_server.hpp"

namespace fieldcast::web {

using namespace std::chrono_literals;

class HttpSessionTest : public testing::Test {
 protected:
  HttpSessionTest() {
    site_.set_local_role(Role::kOperator);
    add(Method::kGet, "/hello", [](const HttpRequest&, const Caller&, const Reply& reply) {
      HttpResponse response;
      response.body = "hello";
      reply(std::move(response));
    });
    add(Method::kPost, "/echo", [](const HttpRequest& request, const Caller&, const Reply& reply) {
      HttpResponse response;
      response.body = request.body;
      reply(std::move(response));
    });
    add(Method::kGet, "/later",
        [this](const HttpRequest&, const Caller&, const Reply& reply) { later_ = reply; });
    add(Method::kGet, "/large", [](const HttpRequest&, const Caller&, const Reply& reply) {
      HttpResponse response;
      response.body = std::string(1'000'000, 'x');
      reply(std::move(response));
    });
    add(Method::kGet, "/pieces", [this](const HttpRequest&, const Caller&, const Reply& reply) {
      HttpResponse response;
      response.next = [this, left = 3](const std::function<void(Piece)>& take) mutable {
        ++asked_;
        left-- > 0 ? take("piece" + std::to_string(left)) : take(std::nullopt);
      };
      reply(std::move(response));
    });
  }
  void add(Method method, const char* path, Handler handler) {
    site_.routes().add({method, path, Access::kViewer, std::move(handler)});
  }
  std::shared_ptr<MemoryLink> connect() {
    auto link = std::make_shared<MemoryLink>();
    server_.http().accept(std::make_unique<MemoryStream>(io_, link), "127.0.0.1");
    return link;
  }
  void settle() {
    io_.restart();
    io_.poll();
  }
  void wait_until(const std::function<bool()>& done) {
    const auto end = std::chrono::steady_clock::now() + 5s;
    while (!done() && std::chrono::steady_clock::now() < end) {
      io_.restart();
      io_.run_one_for(50ms);
    }
    EXPECT_TRUE(done());
  }
  std::string send(const std::shared_ptr<MemoryLink>& link, const std::string& bytes) {
    link->to_client.clear();
    link->to_station += bytes;
    link->wake();
    settle();
    return link->to_client;
  }
  static std::string get(const std::string& target, const std::string& more = {}) {
    return "GET " + target + " HTTP/1.1\r\nHost: 127.0.0.1:8090\r\n" + more + "\r\n";
  }
  static std::string post(const std::string& body, const std::string& more = {}) {
    return "POST /echo HTTP/1.1\r\nHost: 127.0.0.1:8090\r\nOrigin: http://127.0.0.1:8090\r\n"
           "Content-Type: application/json\r\n" +
           more + "\r\n" + body;
  }
  static std::size_t count(const std::string& text, const std::string& part) {
    std::size_t found = 0;
    for (std::size_t at = 0; (at = text.find(part, at)) != text.npos; at += part.size()) ++found;
    return found;
  }

  boost::asio::io_context io_;
  Site site_{{.listen = {"127.0.0.1", 8090}}, {steady_now, [] { return UtcTime{}; }}, {}};
  StationServer server_{io_, site_, {}, limits_with()};
  Reply later_;
  int asked_ = 0;

 private:
  static StationLimits limits_with() {
    StationLimits limits;
    limits.connections = {.total = 4, .of_one = 4, .working_of_one = 4, .reserved = 0};
    limits.http.idle = 400ms;
    limits.http.header = 400ms;
    limits.http.body = 400ms;
    limits.http.handler = 200ms;
    limits.http.progress = 200ms;
    limits.http.linger = 50ms;
    return limits;
  }
};

}  // namespace fieldcast::web
