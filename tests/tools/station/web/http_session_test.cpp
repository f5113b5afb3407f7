#include <sstream>

#include "tests/tools/station/web/http_session_fixture.hpp"

namespace fieldcast::web {
namespace {

using testing::EndsWith;
using testing::HasSubstr;
using testing::StartsWith;

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
        get("/hello", std::string("A: b\0c\r\n", 8)), std::string("GET /hello HTTP/1.1\n"),
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

TEST_F(HttpSessionTest, OnlyACallerOfARouteWithLargeBodiesMaySendOne) {
  const auto size = [](const HttpRequest& request, const Caller&, const Reply& reply) {
    HttpResponse response;
    response.body = "got " + std::to_string(request.body.size());
    reply(std::move(response));
  };
  site_.routes().add({Method::kPost, "/upload", Access::kOperator, size, 100'000});
  const auto upload = [this](const char* path, std::size_t bytes, bool chunked) {
    const std::string body = '"' + std::string(bytes - 2, 'x') + '"';
    std::string head = std::string("POST ") + path +
                       " HTTP/1.1\r\nHost: 127.0.0.1:8090\r\nOrigin: http://127.0.0.1:8090\r\n"
                       "Content-Type: application/json\r\n";
    if (!chunked)
      return send(connect(), head + "Content-Length: " + std::to_string(bytes) + "\r\n\r\n" + body);
    std::ostringstream chunk;
    chunk << std::hex << bytes << "\r\n" << body << "\r\n0\r\n\r\n";
    return send(connect(), head + "Transfer-Encoding: chunked\r\n\r\n" + chunk.str());
  };
  for (const bool chunked : {false, true}) {
    EXPECT_THAT(upload("/upload", 100'000, chunked), HasSubstr("got 100000"));
    EXPECT_THAT(upload("/upload", 100'001, chunked), HasSubstr("at most 100000 bytes"));
    EXPECT_THAT(upload("/echo", 70'000, chunked), HasSubstr("at most 65536 bytes"));
    EXPECT_THAT(upload("/none", 70'000, chunked), HasSubstr("at most 65536 bytes"));
    EXPECT_THAT(upload("/upload", 600'000, chunked), HasSubstr("HTTP/1.1 413"));
  }
  site_.set_local_role(Role::kViewer);
  EXPECT_THAT(upload("/upload", 70'000, false), HasSubstr("at most 65536 bytes"));
}

}  // namespace
}  // namespace fieldcast::web
