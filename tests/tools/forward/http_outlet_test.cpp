#include "tools/forward/outlet/http/http_outlet.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <netinet/in.h>
#include <sys/socket.h>

#include <atomic>
#include <functional>
#include <thread>

#include "bridge/base/file_descriptor.hpp"
#include "tests/bridge/support/captured_log.hpp"
#include "tests/tools/forward/batch_support.hpp"
#include "tools/forward/outlet/influxdb/gzip.hpp"
#include "tools/forward/outlet/influxdb/influxdb.hpp"
#include "tools/forward/payload/codec.hpp"

namespace fieldcast::forward {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

struct Reply {
  int status = 204;
  std::string text;
};

// Serves one request for each connection, on its own thread.
class HttpServer {
 public:
  // Returns the response to a body. Called on the thread of the server.
  explicit HttpServer(std::function<Reply(const std::string& body)> reply)
      : reply_(std::move(reply)) {
    listening_.reset(::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0));
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    (void)::bind(listening_.get(), reinterpret_cast<sockaddr*>(&address), sizeof address);
    (void)::listen(listening_.get(), 8);
    socklen_t size = sizeof address;
    (void)::getsockname(listening_.get(), reinterpret_cast<sockaddr*>(&address), &size);
    url_ = "http://127.0.0.1:" + std::to_string(ntohs(address.sin_port));
    thread_ = std::thread([this] { serve(); });
  }
  ~HttpServer() {
    (void)::shutdown(listening_.get(), SHUT_RDWR);  // ends accept()
    thread_.join();
  }
  HttpServer(const HttpServer&) = delete;
  HttpServer& operator=(const HttpServer&) = delete;

  [[nodiscard]] std::string url() const { return url_; }

 private:
  void serve() {
    for (;;) {
      FileDescriptor connection;
      connection.reset(::accept4(listening_.get(), nullptr, nullptr, SOCK_CLOEXEC));
      if (connection.get() < 0) return;
      const Reply reply = reply_(body_of(connection.get()));
      const std::string text =
          "HTTP/1.1 " + std::to_string(reply.status) + " X\r\nConnection: close\r\n" +
          (reply.status == 204 ? ""
                               : "Content-Length: " + std::to_string(reply.text.size()) + "\r\n") +
          "\r\n" + reply.text;
      (void)::send(connection.get(), text.data(), text.size(), MSG_NOSIGNAL);
    }
  }

  static std::string body_of(int connection) {
    std::string request;
    for (char part[4096];;) {
      const std::size_t head = request.find("\r\n\r\n");
      if (head != std::string::npos) {
        const std::size_t length = request.find("Content-Length: ");
        const std::size_t size = std::stoul(request.substr(length + 16));
        if (request.size() >= head + 4 + size) return request.substr(head + 4);
      }
      const ssize_t count = ::recv(connection, part, sizeof part, 0);
      if (count <= 0) return request;
      request.append(part, static_cast<std::size_t>(count));
    }
  }

  const std::function<Reply(const std::string& body)> reply_;
  FileDescriptor listening_;
  std::string url_;
  std::thread thread_;
};

// An engine that writes the bodies of records as they are.
HttpEngine plain_engine() {
  HttpEngine engine;
  engine.subject = "test";
  engine.encode = [](const Record& record) { return std::optional(record.body); };
  engine.compress = [](const std::string& body) { return body; };
  return engine;
}

std::vector<Record> records(const std::vector<std::string>& bodies) {
  std::vector<Record> made;
  for (const std::string& body : bodies)
    made.push_back({.bus = "line", .device = "press", .body = body});
  return made;
}

// Outcomes of these records in one turn; empty if the outlet is not ready.
std::vector<Outcome> outcomes(Outlet& outlet, std::vector<Record> records, Instant now = {}) {
  if (!outlet.is_ready(now)) return {};
  for (std::size_t i = 0; i < records.size(); ++i) {
    records[i].id = i;
    EXPECT_TRUE(outlet.send(records[i]));
  }
  outlet.flush();
  const auto results = outlet.take_results();
  EXPECT_EQ(results.size(), records.size());
  std::vector<Outcome> found(records.size());
  for (const OutletResult& result : results) found.at(result.record) = result.outcome;
  return found;
}

HttpSpec spec_of(const HttpServer& server) { return {.server = server.url()}; }

TEST(HttpOutlet, AServerThatRefusesEverythingLosesNoMessage) {
  for (const int status : {400, 413, 422}) {
    const HttpServer server([&](const std::string&) {
      return Reply{status, "Client sent an HTTP request to an HTTPS server."};
    });
    HttpOutlet outlet(spec_of(server), plain_engine(), [] {});
    EXPECT_THAT(outcomes(outlet, records({"a", "b"})),
                ElementsAre(Outcome::kFailed, Outcome::kFailed));
  }
}

TEST(HttpOutlet, AServerThatRespondsWithAnotherStatusIsNotUsed) {
  for (const int status : {301, 404, 405, 500}) {
    const HttpServer server([&](const std::string&) { return Reply{status, {}}; });
    HttpOutlet outlet(spec_of(server), plain_engine(), [] {});
    EXPECT_THAT(outcomes(outlet, records({"a"})), IsEmpty());
  }
}

TEST(HttpOutlet, ARefusedMessageIsRemovedIfTheServerAcceptsARequestWithoutData) {
  const HttpServer server([](const std::string& body) { return Reply{body.empty() ? 204 : 400}; });
  HttpOutlet outlet(spec_of(server), plain_engine(), [] {});
  EXPECT_THAT(outcomes(outlet, records({"bad"})), ElementsAre(Outcome::kRefused));
}

TEST(HttpOutlet, ARefusedMessageIsRemovedIfTheServerAcceptsAnotherOne) {
  const HttpServer server([](const std::string& body) { return Reply{body == "b" ? 204 : 400}; });
  HttpOutlet outlet(spec_of(server), plain_engine(), [] {});
  EXPECT_THAT(outcomes(outlet, records({"a", "b", "c"})),
              ElementsAre(Outcome::kRefused, Outcome::kAcknowledged, Outcome::kRefused));
}

TEST(HttpOutlet, AServerThatChangesWhileItIsUsedLosesNoMessage) {
  std::atomic<bool> is_wrong = false;
  const HttpServer server([&](const std::string&) { return Reply{is_wrong ? 400 : 204}; });
  HttpOutlet outlet(spec_of(server), plain_engine(), [] {});
  EXPECT_THAT(outcomes(outlet, records({"a"})), ElementsAre(Outcome::kAcknowledged));
  is_wrong = true;
  EXPECT_THAT(outcomes(outlet, records({"a"})), ElementsAre(Outcome::kFailed));
  is_wrong = false;
  EXPECT_THAT(outcomes(outlet, records({"a"}), Instant{std::chrono::minutes{1}}),
              ElementsAre(Outcome::kAcknowledged));
}

TEST(HttpOutlet, AFailureAfterARefusalKeepsBothMessages) {
  const HttpServer server([](const std::string& body) {
    return Reply{body.empty() ? 204 : body == "b" ? 500 : 400};
  });
  HttpOutlet outlet(spec_of(server), plain_engine(), [] {});
  EXPECT_THAT(outcomes(outlet, records({"a", "b"})),
              ElementsAre(Outcome::kFailed, Outcome::kFailed));
}

// Regression: the forwarder repeated these messages without an end.
TEST(HttpOutlet, ARefusalWithAnotherStatusIsRecognisedByItsReason) {
  const HttpServer server([](const std::string& body) {
    if (body.find("old") == std::string::npos) return Reply{};
    return Reply{500, "too old sample"};
  });
  HttpEngine engine = plain_engine();
  engine.refusal = "too old sample";
  HttpOutlet outlet(spec_of(server), std::move(engine), [] {});
  EXPECT_THAT(outcomes(outlet, records({"old", "new"})),
              ElementsAre(Outcome::kRefused, Outcome::kAcknowledged));
}

// Regression: the database was ignored without a word.
TEST(InfluxdbOutlet, WarnsOfADatabaseBesideABucket) {
  const auto warns = [](const InfluxdbSpec& spec) {
    test::CapturedLog log;
    (void)make_influxdb(spec, {});
    return log.end().find("have no effect beside 'bucket'") != std::string::npos;
  };
  EXPECT_FALSE(warns({.organization = "o", .bucket = "b"}));
  EXPECT_TRUE(warns({.organization = "o", .bucket = "b", .create = true}));
  EXPECT_TRUE(warns({.database = "d", .organization = "o", .bucket = "b"}));
  EXPECT_FALSE(warns({.database = "d", .create = true}));
}

TEST(HttpOutlet, TheRefusalOfAnEmptyBodyByInfluxdb2IsRecognised) {
  const HttpServer server([](const std::string& body) {
    const char* const reason = body == gzipped({}) ? "writing requires points" : "unable to parse";
    return Reply{400, fmt::format(R"({{"code":"invalid","message":"{}"}})", reason)};
  });
  const InfluxdbSpec spec{.http = spec_of(server), .organization = "o", .bucket = "b"};
  const auto outlet = make_influxdb(
      spec, {.site = "north",
             .catalogue = [](std::uint64_t) { return encode("north", catalogue({"a"})); },
             .wake = [] {}});
  EXPECT_THAT(outcomes(*outlet, {record_of(seconds(0, 1))}), ElementsAre(Outcome::kRefused));
}

}  // namespace
}  // namespace fieldcast::forward
