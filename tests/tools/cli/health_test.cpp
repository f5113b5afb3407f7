#include "tools/cli/command/health.hpp"

#include <arpa/inet.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/socket.h>

#include <sstream>
#include <thread>

#include "bridge/base/file_descriptor.hpp"

namespace fieldcast::cli {
namespace {

using testing::HasSubstr;

// Accepts one connection, reads its request and sends a fixed response.
class OneResponse {
 public:
  explicit OneResponse(std::string response)
      : listener_(::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0)) {
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    socklen_t size = sizeof address;
    auto* const general = reinterpret_cast<sockaddr*>(&address);
    EXPECT_EQ(::bind(listener_.get(), general, size), 0);
    EXPECT_EQ(::getsockname(listener_.get(), general, &size), 0);
    port_ = ntohs(address.sin_port);
    EXPECT_EQ(::listen(listener_.get(), 1), 0);
    if (response.empty()) return;
    thread_ = std::thread([this, response = std::move(response)] {
      const FileDescriptor client(::accept(listener_.get(), nullptr, nullptr));
      char piece[1024];
      while (request_.find("\r\n\r\n") == std::string::npos) {
        const ssize_t count = ::recv(client.get(), piece, sizeof piece, 0);
        if (count <= 0) return;
        request_.append(piece, static_cast<std::size_t>(count));
      }
      (void)::send(client.get(), response.data(), response.size(), MSG_NOSIGNAL);
    });
  }
  ~OneResponse() {
    if (thread_.joinable()) thread_.join();
  }
  OneResponse(const OneResponse&) = delete;
  OneResponse& operator=(const OneResponse&) = delete;

  [[nodiscard]] std::string host() const { return "127.0.0.1:" + std::to_string(port_); }
  [[nodiscard]] const std::string& request() {
    thread_.join();
    return request_;
  }

 private:
  FileDescriptor listener_;
  std::uint16_t port_ = 0;
  std::string request_;
  std::thread thread_;
};

struct Checked {
  ExitCode code;
  std::string err;
};
Checked check(const std::string& url) {
  std::istringstream in;
  std::ostringstream out, err;
  const ExitCode code =
      health({.url = url, .timeout = std::chrono::seconds{1}}, Streams{in, out, err});
  return {code, err.str()};
}

TEST(Health, IsGoodWithStatus200) {
  OneResponse server("HTTP/1.1 200 OK\r\ncontent-length: 3\r\nconnection: close\r\n\r\nok\n");
  EXPECT_EQ(check("http://" + server.host() + "/healthz").code, ExitCode::kOk);
  const std::string& request = server.request();
  EXPECT_THAT(request, testing::StartsWith("GET /healthz HTTP/1."));
  EXPECT_THAT(request, HasSubstr("\r\nHost: " + server.host() + "\r\n"));
}

TEST(Health, IsBadWithAnotherStatus) {
  OneResponse server(
      "HTTP/1.1 503 Service Unavailable\r\ncontent-length: 3\r\nconnection: close\r\n\r\nno\n");
  const Checked checked = check("http://" + server.host() + "/healthz");
  EXPECT_EQ(checked.code, ExitCode::kFound);
  EXPECT_THAT(checked.err, testing::AnyOf(HasSubstr("503"), HasSubstr("healthz: no\n")));
}

TEST(Health, IsBadWithoutAServer) {
  std::string host;
  { host = OneResponse("").host(); }
  const Checked checked = check("http://" + host + "/healthz");
  EXPECT_EQ(checked.code, ExitCode::kFound);
  EXPECT_THAT(checked.err, HasSubstr("http://" + host + "/healthz: connect timeout"));
}

TEST(Health, IsBadIfTheServerDoesNotRespondInTime) {
  const OneResponse server("");
  const auto begin = std::chrono::steady_clock::now();
  EXPECT_EQ(check("http://" + server.host() + "/healthz").code, ExitCode::kFound);
  EXPECT_LT(std::chrono::steady_clock::now() - begin, std::chrono::seconds{5});
}

TEST(Health, NeedsAUrl) {
  const Checked checked = check("127.0.0.1:9464");
  EXPECT_EQ(checked.code, ExitCode::kUsage);
  EXPECT_THAT(checked.err, HasSubstr("expected http://HOST:PORT/healthz"));
}

}  // namespace
}  // namespace fieldcast::cli
