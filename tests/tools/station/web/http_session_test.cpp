#include "bridge/http/http_session.hpp"

#include <gmock/gmock.h>

#include "bridge/base/clock.hpp"
#include "tests/tools/station/web/memory_stream.hpp"
#include "tools/station/web/station_server.hpp"

namespace fieldcast::web {
namespace {

using namespace std::chrono_literals;
using testing::EndsWith;
using testing::HasSubstr;
using testing::Not;
using testing::StartsWith;

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

TEST_F(HttpSessionTest, OneConnectionServesManyRequests) {
  const auto link = connect();
  for (int i = 0; i < 3; ++i) {
    const std::string response = send(link, get("/hello"));
    EXPECT_THAT(response, StartsWith("HTTP/1.1 200 OK\r\n"));
    EXPECT_THAT(response, HasSubstr("connection: keep-alive\r\n"));
    EXPECT_THAT(response, HasSubstr("content-length: 5\r\n"));
    EXPECT_THAT(response, HasSubstr("content-security-policy: default-src 'none'"));
    EXPECT_THAT(response, EndsWith("\r\n\r\nhello"));
  }
  EXPECT_FALSE(link->station_closed);
  EXPECT_EQ(server_.counters().requests, 3u);
}

TEST_F(HttpSessionTest, RequestsSentAheadGetResponsesInOrder) {
  const auto link = connect();
  const std::string response = send(link, post("1", "Content-Length: 1\r\n") + get("/hello") +
                                              post("22", "Content-Length: 2\r\n"));
  EXPECT_EQ(count(response, "HTTP/1.1 200 OK"), 3u);
  EXPECT_LT(response.find("\r\n\r\n1"), response.find("\r\n\r\nhello"));
  EXPECT_THAT(response, EndsWith("\r\n\r\n22"));
}

TEST_F(HttpSessionTest, ARequestMayComeInAnyPieces) {
  const std::string request = post("{\"a\": 1}", "Content-Length: 8\r\n");
  for (std::size_t cut = 1; cut < request.size(); ++cut) {
    const auto link = connect();
    send(link, request.substr(0, cut));
    EXPECT_THAT(send(link, request.substr(cut)), EndsWith("\r\n\r\n{\"a\": 1}")) << cut;
    link->client_gone = true;
    link->wake();
    settle();
  }
  const auto link = connect();
  link->most_of_a_read = 1;
  EXPECT_THAT(send(link, request), EndsWith("\r\n\r\n{\"a\": 1}"));
}

TEST_F(HttpSessionTest, AClientMayAskForTheEndOfTheConnection) {
  auto link = connect();
  EXPECT_THAT(send(link, get("/hello", "Connection: close\r\n")), HasSubstr("connection: close"));
  EXPECT_TRUE(link->station_ended);
  wait_until([&] { return link->station_closed; });
  link = connect();
  EXPECT_THAT(send(link, "GET /hello HTTP/1.0\r\nHost: 127.0.0.1:8090\r\n\r\n"),
              EndsWith("\r\n\r\nhello"));
  EXPECT_TRUE(link->station_ended);
}

TEST_F(HttpSessionTest, WhatIsNotARequestIsRefusedAndEndsTheConnection) {
  for (const std::string& bytes :
       {std::string("\x16\x03\x01\x02\x00\x01\x00\x01\xfc\x03\x03", 11),
        std::string("\r\n\r\nx\r\n"), std::string("GET\r\n\r\n"),
        std::string("GET / HTTP/9.9\r\n\r\n"), std::string("GET / HTTP/1.1\r\nHost 1\r\n\r\n"),
        std::string("G\0T / HTTP/1.1\r\n\r\n", 18), post("1", "Content-Length: x\r\n"),
        post("1", "Content-Length: 1\r\nContent-Length: 2\r\n"),
        post("0\r\n\r\n", "Content-Length: 1\r\nTransfer-Encoding: chunked\r\n"),
        post("zz\r\n", "Transfer-Encoding: chunked\r\n")}) {
    const auto link = connect();
    EXPECT_THAT(send(link, bytes), StartsWith("HTTP/1.1 400 Bad Request\r\n")) << bytes;
    EXPECT_TRUE(link->station_ended);
    link->client_gone = true;
    link->wake();
    settle();
    EXPECT_TRUE(link->station_closed);
  }
}

TEST_F(HttpSessionTest, AHeaderThatAProxyCouldReadDifferentlyIsRefused) {
  const std::string chunks = "0\r\n\r\n";
  const auto refusal_of = [&](const std::string& bytes) {
    const auto link = connect();
    const std::string status = send(link, bytes).substr(0, 12);
    EXPECT_TRUE(link->station_ended) << bytes;
    link->client_gone = true;
    link->wake();
    settle();
    return status;
  };
  for (const std::string coding : {"gzip", "identity", "gzip, chunked", "chunked, chunked", "x"})
    EXPECT_EQ(refusal_of(post(chunks, "Transfer-Encoding: " + coding + "\r\n")), "HTTP/1.1 501")
        << coding;
  for (const std::string& bytes :
       {post("1", "Content-Length: 1\r\nContent-Length: 1\r\n"),
        post("1", "Content-Length: 1, 1\r\n"), post("1", "Content-Length: +1\r\n"),
        post(chunks, "Transfer-Encoding: chunked\r\nContent-Length: 5\r\n"),
        post(chunks, "Content-Length: 5\r\nTransfer-Encoding: x\r\n"),
        post(chunks, "Transfer-Encoding: chunked\r\nTransfer-Encoding: chunked\r\n"),
        post(chunks, "Transfer-Encoding : chunked\r\n"),
        post("0\r\nOrigin: x\r\n\r\n", "Transfer-Encoding: chunked\r\n"),
        get("/hello", "A: b\r\n folded\r\n"), get("/hello", " A: b\r\n"),
        get("/hello", "A : b\r\n"), get("/hello", "A\r\n"), get("/hello", ": b\r\n"),
        get("/hello", "A: b\n"), get("/hello", "A: b\rC: d\r\n"),
        get("/hello", std::string("A: b\0c\r\n", 9)), std::string("GET /hello HTTP/1.1\n"),
        std::string("POST /echo HTTP/1.0\r\nTransfer-Encoding: chunked\r\n\r\n")})
    EXPECT_EQ(refusal_of(bytes), "HTTP/1.1 400") << bytes;
}

TEST_F(HttpSessionTest, HeadHasTheHeaderOfGetAndNoBody) {
  const auto link = connect();
  for (const char* path : {"/hello", "/pieces", "/none"}) {
    const std::string request = get(path);
    const std::string whole = send(link, request);
    const std::string head = send(link, "HEAD" + request.substr(3));
    EXPECT_EQ(head, whole.substr(0, whole.find("\r\n\r\n") + 4)) << path;
  }
  EXPECT_THAT(send(link, get("/hello")), EndsWith("\r\n\r\nhello"));
}

TEST_F(HttpSessionTest, OptionsAndAnUnknownMethodReturnWhatIsAllowed) {
  const auto link = connect();
  const std::string request = get("/hello").substr(3);
  EXPECT_THAT(send(link, "OPTIONS" + request), StartsWith("HTTP/1.1 204 No Content\r\n"));
  EXPECT_THAT(link->to_client, HasSubstr("\r\nallow: GET, HEAD, OPTIONS\r\n"));
  EXPECT_THAT(send(link, "TRACE" + request), StartsWith("HTTP/1.1 405 "));
  EXPECT_THAT(link->to_client, HasSubstr("\r\nallow: GET, HEAD, OPTIONS\r\n"));
  EXPECT_THAT(send(link, "OPTIONS" + get("/none").substr(3)), StartsWith("HTTP/1.1 404 "));
}

TEST_F(HttpSessionTest, HeaderAndBodyHaveALimit) {
  auto link = connect();
  EXPECT_THAT(send(link, get("/hello", "A: " + std::string(7'900, 'a') + "\r\n")),
              HasSubstr("200 OK"));
  for (const std::string& bytes :
       {get("/hello", "A: " + std::string(8'200, 'a') + "\r\n"), get("/" + std::string(9'000, 'a')),
        "GET / HTTP/1.1\r\n" + std::string(20'000, 'a'), std::string(20'000, 'a')}) {
    link = connect();
    EXPECT_THAT(send(link, bytes),
                testing::AnyOf(StartsWith("HTTP/1.1 431"), StartsWith("HTTP/1.1 400")));
    EXPECT_TRUE(link->station_ended);
  }
}

TEST_F(HttpSessionTest, ABodyThatIsTooLongIsRefused) {
  auto link = connect();
  const std::string most(64 * 1024, 'b');
  EXPECT_THAT(send(link, post(most, "Content-Length: 65536\r\n")), EndsWith("\r\n\r\n" + most));
  EXPECT_THAT(send(link, post("", "Content-Length: 65537\r\n")), StartsWith("HTTP/1.1 413"));
  link = connect();
  const std::string chunk = "8000\r\n" + std::string(0x8000, 'c') + "\r\n";
  EXPECT_THAT(
      send(link, post(chunk + chunk + "1\r\nc\r\n0\r\n\r\n", "Transfer-Encoding: chunked\r\n")),
      StartsWith("HTTP/1.1 413"));
}

TEST_F(HttpSessionTest, AClientThatExpectsContinueGetsContinue) {
  const auto link = connect();
  EXPECT_EQ(send(link, post("", "Content-Length: 2\r\nExpect: 100-continue\r\n")),
            "HTTP/1.1 100 Continue\r\n\r\n");
  EXPECT_THAT(send(link, "{}"), EndsWith("\r\n\r\n{}"));
}

TEST_F(HttpSessionTest, ARequestThatTakesTooLongIsRefused) {
  const auto link = connect();
  const auto began = std::chrono::steady_clock::now();
  auto next = began;
  send(link, "GET /hello HTTP/1.1\r\nA: ");
  wait_until([&] {  // byte by byte, without an end
    if (std::chrono::steady_clock::now() >= next) link->to_station += 'a';
    next = std::chrono::steady_clock::now() + 20ms;
    link->wake();
    return link->station_ended;
  });
  EXPECT_THAT(link->to_client, StartsWith("HTTP/1.1 408 Request Timeout\r\n"));
  EXPECT_LT(std::chrono::steady_clock::now() - began, 3s);
  wait_until([&] { return link->station_closed; });
}

TEST_F(HttpSessionTest, ABodyThatTakesTooLongIsRefused) {
  const auto link = connect();
  const auto began = std::chrono::steady_clock::now();
  auto next = began;
  send(link, post("", "Content-Length: 60000\r\n"));
  wait_until([&] {
    if (std::chrono::steady_clock::now() >= next) link->to_station += 'a';
    next = std::chrono::steady_clock::now() + 20ms;
    link->wake();
    return link->station_ended;
  });
  EXPECT_THAT(link->to_client, StartsWith("HTTP/1.1 408 Request Timeout\r\n"));
  EXPECT_LT(std::chrono::steady_clock::now() - began, 3s);
  wait_until([&] { return link->station_closed; });
}

TEST_F(HttpSessionTest, AConnectionWithoutRequestsIsClosed) {
  const auto silent = connect(), served = connect();
  send(served, get("/hello"));
  wait_until([&] { return silent->station_closed && served->station_closed; });
  EXPECT_EQ(silent->to_client, "");
}

TEST_F(HttpSessionTest, AClientThatLeavesIsForgotten) {
  for (const char* bytes : {"", "GET /he", "GET /later HTTP/1.1\r\nHost: 127.0.0.1:8090\r\n\r\n"}) {
    const auto link = connect();
    send(link, bytes);
    link->client_gone = true;
    link->wake();
    settle();
    if (later_) later_(HttpResponse{});
    settle();
    EXPECT_TRUE(link->station_closed) << bytes;
  }
  EXPECT_EQ(server_.counters().open, 0u);
}

TEST_F(HttpSessionTest, AResponseMayComeLaterAndOnce) {
  const auto link = connect();
  EXPECT_EQ(send(link, get("/later")), "");
  HttpResponse response;
  response.body = "now";
  const Reply reply = later_;
  reply(response);
  reply(response);
  settle();
  EXPECT_EQ(count(link->to_client, "HTTP/1.1"), 1u);
  EXPECT_THAT(link->to_client, EndsWith("\r\n\r\nnow"));
  send(link, get("/later"));
  reply(response);  // of the first request
  settle();
  EXPECT_EQ(link->to_client, "");
}

TEST_F(HttpSessionTest, AStationThatNeverRespondsIsSaidToBeBusy) {
  const auto link = connect();
  send(link, get("/later"));
  wait_until([&] { return link->station_ended; });
  EXPECT_THAT(link->to_client, StartsWith("HTTP/1.1 503 Service Unavailable\r\n"));
}

TEST_F(HttpSessionTest, AStreamComesInChunks) {
  const auto link = connect();
  EXPECT_THAT(send(link, get("/pieces")), HasSubstr("\r\ntransfer-encoding: chunked\r\n"));
  EXPECT_THAT(link->to_client,
              EndsWith("\r\n\r\n6\r\npiece2\r\n6\r\npiece1\r\n6\r\npiece0\r\n0\r\n\r\n"));
  EXPECT_THAT(send(link, get("/hello")), HasSubstr("hello"));
}

TEST_F(HttpSessionTest, AnOldClientGetsAStreamUntilTheEnd) {
  const auto link = connect();
  const std::string response = send(link, "GET /pieces HTTP/1.0\r\nHost: 127.0.0.1:8090\r\n\r\n");
  EXPECT_THAT(response, EndsWith("\r\n\r\npiece2piece1piece0"));
  EXPECT_THAT(response, Not(HasSubstr("chunked")));
  EXPECT_TRUE(link->station_ended);
}

TEST_F(HttpSessionTest, ThereIsNoPieceAheadOfTheClient) {
  const auto link = connect();
  link->takes = 0;
  send(link, get("/pieces"));
  EXPECT_EQ(asked_, 0);
  link->takes = 10'000;
  link->wake();
  settle();
  EXPECT_EQ(asked_, 4);
}

TEST_F(HttpSessionTest, AClientThatStopsReadingIsClosed) {
  const auto link = connect();
  link->takes = 300'000;
  send(link, get("/large"));
  wait_until([&] { return link->station_closed; });
  EXPECT_EQ(link->to_client.size(), 300'000u);
}

TEST_F(HttpSessionTest, AClientThatReadsSlowlyGetsEverything) {
  const auto link = connect();
  link->takes = 1;
  send(link, get("/large"));
  wait_until([&] {
    link->takes = 10'000;
    link->wake();
    return link->to_client.size() > 1'000'000;
  });
  EXPECT_FALSE(link->station_closed);
}

TEST_F(HttpSessionTest, AClientThatReadsForTooLongIsClosed) {
  StationLimits limits;
  limits.http.response = 300ms;
  StationServer server(io_, site_, {}, limits);
  const auto link = std::make_shared<MemoryLink>();
  server.http().accept(std::make_unique<MemoryStream>(io_, link), "127.0.0.1");
  link->takes = 1;
  send(link, get("/large"));
  wait_until([&] {
    link->takes = 1;
    link->wake();
    return link->station_closed;
  });
  EXPECT_LT(link->to_client.size(), 1'000'000u);
}

TEST_F(HttpSessionTest, TheConnectionThatWasIdleForLongestMakesWay) {
  const auto busy = connect();
  send(busy, get("/later"));
  std::vector<std::shared_ptr<MemoryLink>> links;
  for (int i = 0; i < 3; ++i) {
    links.push_back(connect());
    send(links.back(), get("/hello"));
  }
  send(links[0], get("/hello"));  // no longer the oldest
  const auto more = connect();
  EXPECT_TRUE(links[1]->station_closed);
  EXPECT_FALSE(links[0]->station_closed);
  EXPECT_FALSE(busy->station_closed);
  EXPECT_THAT(send(more, get("/hello")), HasSubstr("hello"));
  EXPECT_EQ(server_.counters().turned_away, 1u);
}

TEST_F(HttpSessionTest, WhereNobodyIsIdleNewOnesAreTurnedAway) {
  for (int i = 0; i < 4; ++i) send(connect(), get("/later"));
  EXPECT_TRUE(connect()->station_closed);
  EXPECT_EQ(server_.counters().open, 4u);
  EXPECT_EQ(server_.counters().turned_away, 1u);
}

TEST_F(HttpSessionTest, RequestsThatAreNotWholeMakeWay) {
  std::vector<std::shared_ptr<MemoryLink>> links;
  for (const std::string& part : {std::string(), std::string("GET"), get("/hello").substr(0, 30),
                                  post("", "Content-Length: 9\r\n")}) {
    links.push_back(connect());
    send(links.back(), part);
  }
  for (std::size_t i = 0; i < links.size(); ++i) {
    const auto more = connect();
    EXPECT_TRUE(links[i]->station_closed) << i;
    EXPECT_THAT(send(more, get("/hello")), HasSubstr("hello"));
  }
  EXPECT_EQ(server_.counters().open, 4u);
  EXPECT_EQ(server_.counters().turned_away, 4u);
}

TEST_F(HttpSessionTest, WithoutLiveValuesThereIsNoWebSocket) {
  const auto link = connect();
  const std::string upgrade =
      "Origin: http://127.0.0.1:8090\r\nConnection: Upgrade\r\nUpgrade: websocket\r\n"
      "Sec-WebSocket-Version: 13\r\nSec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\n"
      "Sec-WebSocket-Protocol: fieldcast.1\r\n";
  EXPECT_THAT(send(link, get("/live", upgrade)), StartsWith("HTTP/1.1 404"));
}

TEST_F(HttpSessionTest, TheStopClosesEveryConnection) {
  const auto idle = connect(), busy = connect();
  send(busy, get("/later"));
  bool done = false;
  server_.close([&] { done = true; });
  settle();
  EXPECT_TRUE(done);
  EXPECT_TRUE(idle->station_closed);
  EXPECT_TRUE(busy->station_closed);
  EXPECT_TRUE(connect()->station_closed);
}

}  // namespace
}  // namespace fieldcast::web
