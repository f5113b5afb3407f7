#include "tests/tools/station/web/http_server_fixture.hpp"

namespace fieldcast::web {
namespace {

TEST_F(HttpServerTest, AWebSocketSpeaksBothWays) {
  RawClient client(port_);
  client.send(RawClient::upgrade(port_));
  const std::string head = client.read_until("\r\n\r\n");
  EXPECT_THAT(head, StartsWith("HTTP/1.1 101 Switching Protocols\r\n"));
  EXPECT_THAT(head, HasSubstr("Sec-WebSocket-Accept: s3pPLMBiTxaQ9kYGzzhZRbK+xOo=\r\n"));
  EXPECT_THAT(head, HasSubstr("Sec-WebSocket-Protocol: fieldcast.1\r\n"));
  EXPECT_EQ(client.next_frame()->second, "hello local");
  client.send(RawClient::frame(1, "ho"));
  const auto frame = client.next_frame();
  EXPECT_EQ(frame->first, 0x81);
  EXPECT_EQ(frame->second, "you said ho");
  client.send(RawClient::frame(1, "wake"));
  EXPECT_EQ(client.next_frame()->second, "awake");
  client.send(RawClient::frame(9, "ping"));
  EXPECT_EQ(client.next_frame(), (std::pair<std::uint8_t, std::string>{0x8a, "ping"}));
}

TEST_F(HttpServerTest, AClosedWebSocketIsForgotten) {
  RawClient asks = live(), says = live(), leaves = live();
  asks.send(RawClient::frame(1, "close"));
  const auto farewell = asks.next_frame();
  EXPECT_EQ(farewell->first, 0x88);
  EXPECT_EQ(farewell->second,
            "\x03\xf0"
            "as you wish");
  asks.send(RawClient::frame(8, ""));
  EXPECT_TRUE(asks.ends());
  says.send(RawClient::frame(8, "\x03\xe8"));
  EXPECT_EQ(says.next_frame()->first, 0x88);
  EXPECT_TRUE(says.ends());
  { const RawClient gone = std::move(leaves); }
  for (int i = 0; i < 100 && open_ > 0; ++i) std::this_thread::sleep_for(10ms);
  EXPECT_EQ(open_, 0);
  EXPECT_EQ(counters().live, 0u);
}

TEST_F(HttpServerTest, AWebSocketOfAnotherSiteIsRefused) {
  for (const char* origin : {"http://evil.example", "null", "https://127.0.0.1"}) {
    RawClient client(port_);
    client.send(RawClient::upgrade(port_, "", origin));
    EXPECT_THAT(client.read_until("\r\n\r\n"), StartsWith("HTTP/1.1 403")) << origin;
    EXPECT_TRUE(client.ends());
  }
  RawClient client(port_);
  std::string request = RawClient::upgrade(port_);
  request.replace(request.find("Host: 127.0.0.1"), 15, "Host: evil.exam");
  client.send(request);
  EXPECT_THAT(client.read_until("\r\n\r\n"), StartsWith("HTTP/1.1 421"));
}

TEST_F(HttpServerTest, AWebSocketNeedsSubprotocolAndVersion) {
  for (const auto& [from, to] :
       {std::pair{"fieldcast.1", "other.1"}, std::pair{"Version: 13", "Version: 7"}}) {
    RawClient client(port_);
    std::string request = RawClient::upgrade(port_);
    request.replace(request.find(from), std::string(from).size(), to);
    client.send(request);
    EXPECT_THAT(client.read_until("\r\n\r\n"),
                testing::AnyOf(StartsWith("HTTP/1.1 400"), StartsWith("HTTP/1.1 426")))
        << to;
    EXPECT_TRUE(client.ends());
  }
  RawClient hasty(port_);
  hasty.send(RawClient::upgrade(port_) + RawClient::frame(1, "early"));
  EXPECT_THAT(hasty.read_until("\r\n\r\n"), StartsWith("HTTP/1.1 400"));
}

TEST_F(HttpServerTest, BrokenFramesEndTheWebSocket) {
  StationLimits limits;
  limits.socket.handshake = 300ms;
  restart(limits);
  const std::string unmasked = "\x81\x02ho", reserved("\xf1\x80\0\0\0\0", 6),
                    odd("\x83\x80\0\0\0\0", 6);
  for (const std::string& bytes :
       {unmasked, reserved, odd, RawClient::frame(2, "binary"), RawClient::frame(1, "\xff\xfe"),
        RawClient::frame(1, std::string(4'097, 'x')), std::string(200, '\xff')}) {
    RawClient client = live();
    client.send(bytes);
    EXPECT_TRUE(client.ends());
  }
  RawClient most = live();
  most.send(RawClient::frame(1, std::string(4'096, 'x')));
  EXPECT_EQ(most.next_frame()->second.size(), 4'096 + 9u);
}

TEST_F(HttpServerTest, ThereAreSixtyFourWebSocketsAndSixteenOfThemAreForLogins) {
  std::vector<RawClient> clients;
  for (int i = 0; i < 48; ++i) clients.push_back(live());
  const auto refused = [&](const std::string& more) {
    RawClient one_more(port_);
    one_more.send(RawClient::upgrade(port_, more));
    return one_more.read_until("\r\n\r\n");
  };
  EXPECT_THAT(refused(""), StartsWith("HTTP/1.1 503"));
  for (const std::string user : {"anna", "bert"}) {
    const std::string cookie = "Cookie: " + log_in(user) + "\r\n";
    for (int i = 0; i < 8; ++i) clients.push_back(live(cookie));
  }
  const std::string cookie = "Cookie: " + log_in("carl") + "\r\n";
  EXPECT_THAT(refused(cookie), StartsWith("HTTP/1.1 503"));
  EXPECT_EQ(counters().live, 64u);
  EXPECT_EQ(counters().turned_away, 2u);
  clients.pop_back();
  for (int i = 0; i < 100 && open_ > 63; ++i) std::this_thread::sleep_for(10ms);
  live(cookie);
}

TEST_F(HttpServerTest, OneUserHasEightAndALogoutEndsThem) {
  const std::string cookie = "Cookie: " + log_in("anna") + "\r\n";
  std::vector<RawClient> clients;
  for (int i = 0; i < 8; ++i) clients.push_back(live(cookie));
  RawClient ninth(port_);
  ninth.send(RawClient::upgrade(port_, cookie));
  EXPECT_THAT(ninth.read_until("\r\n\r\n"), StartsWith("HTTP/1.1 503"));
  RawClient other = live("Cookie: " + log_in("bert") + "\r\n");
  const std::string host = "127.0.0.1:" + std::to_string(port_);
  RawClient out(port_);
  out.send("POST /api/logout HTTP/1.1\r\nHost: " + host + "\r\nOrigin: http://" + host + "\r\n" +
           cookie + "\r\n");
  EXPECT_THAT(out.read_until("\r\n\r\n"), StartsWith("HTTP/1.1 204"));
  for (RawClient& client : clients) EXPECT_EQ(client.next_frame()->first, 0x88);
  other.send(RawClient::frame(1, "still here"));
  EXPECT_EQ(other.next_frame()->second, "you said still here");
}

TEST_F(HttpServerTest, AClientThatStopsReadingHoldsUpNobody) {
  RawClient stopped(port_, 16 * 1024);
  stopped.send(RawClient::upgrade(port_));
  EXPECT_THAT(stopped.read_until("\r\n\r\n"), StartsWith("HTTP/1.1 101"));
  EchoProtocol::frames = 0;
  stopped.send(RawClient::frame(1, "stream"));
  RawClient other = live();
  for (int i = 0; i < 20; ++i) {
    other.send(RawClient::frame(1, "quick"));
    EXPECT_EQ(other.next_frame()->second, "you said quick");
    std::this_thread::sleep_for(5ms);
  }
  // The buffers of the two kernels and one frame.
  const int frames = EchoProtocol::frames;
  EXPECT_LT(frames, 12);
  std::this_thread::sleep_for(100ms);
  EXPECT_EQ(EchoProtocol::frames, frames);
  EXPECT_EQ(stopped.next_frame()->second, "hello local");
  for (int i = 0; i < frames + 5; ++i) EXPECT_EQ(stopped.next_frame()->second.size(), 100'000u);
}

TEST_F(HttpServerTest, AClientThatLeavesTooManyTextsUnreadIsClosed) {
  RawClient client(port_, 4 * 1024);
  client.send(RawClient::upgrade(port_));
  client.read_until("hello local");
  client.send(RawClient::frame(1, "flood"));
  for (int i = 0; i < 300 && open_ > 0; ++i) std::this_thread::sleep_for(10ms);
  EXPECT_EQ(open_, 0);
}

TEST_F(HttpServerTest, AClientWithoutASignOfLifeIsClosed) {
  StationLimits limits;
  limits.socket.idle = 400ms;
  restart(limits);
  RawClient silent = live();
  EXPECT_EQ(silent.next_frame()->first, 0x89);  // a ping without a response
  EXPECT_TRUE(silent.ends());
}

TEST_F(HttpServerTest, TheStopSaysGoodbye) {
  RawClient client = live();
  std::thread stopping([this] { stop(); });
  const auto farewell = client.next_frame();
  EXPECT_EQ(farewell->first, 0x88);
  EXPECT_THAT(farewell->second, HasSubstr("the station stops"));
  client.send(RawClient::frame(8, ""));
  EXPECT_TRUE(client.ends());
  stopping.join();
}

TEST_F(HttpServerTest, AClientThatIgnoresTheGoodbyeDoesNotHoldUpTheStop) {
  StationLimits limits;
  limits.farewell = 200ms;
  restart(limits);
  const RawClient client = live();
  const auto began = std::chrono::steady_clock::now();
  stop();
  EXPECT_LT(std::chrono::steady_clock::now() - began, 2s);
}

}  // namespace
}  // namespace fieldcast::web
