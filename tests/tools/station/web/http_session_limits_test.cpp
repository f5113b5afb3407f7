// Limits in time and number, and responses that come later or in pieces.
#include "tests/tools/station/web/http_session_fixture.hpp"

namespace fieldcast::web {
namespace {

using testing::EndsWith;
using testing::HasSubstr;
using testing::Not;
using testing::StartsWith;

struct SlowRequestTest : HttpSessionTest {
  // Sends `begin`, then byte by byte without an end.
  void expect_timeout_of(const std::string& begin) {
    const auto link = connect();
    const auto began = std::chrono::steady_clock::now();
    auto next = began;
    send(link, begin);
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
};

TEST_F(SlowRequestTest, ARequestThatTakesTooLongIsRefused) {
  expect_timeout_of("GET /hello HTTP/1.1\r\nA: ");
}

TEST_F(SlowRequestTest, ABodyThatTakesTooLongIsRefused) {
  expect_timeout_of(post("", "Content-Length: 60000\r\n"));
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
