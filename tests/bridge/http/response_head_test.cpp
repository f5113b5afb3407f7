#include <gtest/gtest.h>

#include "bridge/http/http_message.hpp"

namespace fieldcast::web {
namespace {

const UtcTime kDate{784'111'777'000'000'000};

TEST(ResponseHead, NamesStatusDateAndLength) {
  HttpResponse response;
  response.headers = {{"etag", "\"1\""}};
  EXPECT_EQ(response_head(response, {kDate, true, 12, false}),
            "HTTP/1.1 200 OK\r\ndate: Sun, 06 Nov 1994 08:49:37 GMT\r\nconnection: keep-alive\r\n"
            "content-type: application/json\r\ncontent-length: 12\r\netag: \"1\"\r\n\r\n");
}

TEST(ResponseHead, AStreamComesInChunks) {
  EXPECT_EQ(response_head({}, {kDate, false, std::nullopt, true}),
            "HTTP/1.1 200 OK\r\ndate: Sun, 06 Nov 1994 08:49:37 GMT\r\nconnection: close\r\n"
            "content-type: application/json\r\ntransfer-encoding: chunked\r\n\r\n");
}

TEST(ResponseHead, WhatHasNoBodyHasNoLength) {
  HttpResponse response;
  response.status = 304;
  EXPECT_EQ(response_head(response, {kDate, true, 0, false}),
            "HTTP/1.1 304 Not Modified\r\ndate: Sun, 06 Nov 1994 08:49:37 GMT\r\n"
            "connection: keep-alive\r\n\r\n");
}

TEST(ResponseHead, NoHeaderBeginsAnother) {
  HttpResponse response;
  response.content_type = "text/plain\r\nx: y";
  response.headers = {{"a", "1\nset-cookie: x"}, {"b\r\nc", "2"}, {"d", std::string("3\0", 2)}};
  EXPECT_EQ(response_head(response, {kDate, true, 0, false}),
            "HTTP/1.1 200 OK\r\ndate: Sun, 06 Nov 1994 08:49:37 GMT\r\nconnection: keep-alive\r\n"
            "content-length: 0\r\n\r\n");
}

}  // namespace
}  // namespace fieldcast::web
