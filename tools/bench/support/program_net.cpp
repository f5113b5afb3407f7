#include "tools/bench/support/program_net.hpp"

#include <netinet/tcp.h>
#include <sys/socket.h>

#include <cerrno>
#include <stdexcept>
#include <thread>

#include "bridge/base/errno_text.hpp"
#include "tools/bench/plant/loopback.hpp"

namespace fieldcast::bench {
namespace {

std::string as_string(const Bytes& bytes) { return {bytes.begin(), bytes.end()}; }

}  // namespace

std::uint16_t free_port() {
  const FileDescriptor fd(::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0));
  sockaddr_in address = loopback(0);
  socklen_t size = sizeof address;
  if (::bind(fd.get(), reinterpret_cast<const sockaddr*>(&address), size) != 0 ||
      ::getsockname(fd.get(), reinterpret_cast<sockaddr*>(&address), &size) != 0) {
    throw std::runtime_error("no free port");
  }
  return ntohs(address.sin_port);
}

FileDescriptor connect_to(std::uint16_t port, double patience) {
  const auto start = Clock::now();
  const sockaddr_in address = loopback(port);
  while (true) {
    FileDescriptor fd(::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0));
    if (::connect(fd.get(), reinterpret_cast<const sockaddr*>(&address), sizeof address) == 0) {
      const int on = 1;
      ::setsockopt(fd.get(), IPPROTO_TCP, TCP_NODELAY, &on, sizeof on);
      return fd;
    }
    if (seconds_since(start) >= patience)
      throw std::runtime_error("cannot connect to port " + std::to_string(port));
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
  }
}

void send_all(int fd, ByteView bytes) {
  while (!bytes.empty()) {
    ssize_t sent = ::send(fd, bytes.data(), bytes.size(), MSG_NOSIGNAL);
    if (sent < 0 && errno == ENOTSOCK) sent = ::write(fd, bytes.data(), bytes.size());
    if (sent < 0 && errno == EINTR) continue;
    if (sent <= 0) throw std::runtime_error("sending: " + errno_text(errno));
    bytes = bytes.subspan(static_cast<std::size_t>(sent));
  }
}

Bytes receive_some(int fd, std::size_t most) {
  Bytes bytes(most);
  ssize_t count = -1;
  do { count = ::read(fd, bytes.data(), bytes.size()); } while (count < 0 && errno == EINTR);
  bytes.resize(count > 0 ? static_cast<std::size_t>(count) : 0);
  return bytes;
}

std::string receive_until(int fd, std::string_view end) {
  std::string text;
  while (!text.ends_with(end)) {
    const Bytes one = receive_some(fd, 1);
    if (one.empty()) throw std::runtime_error("the stream ended after '" + text + "'");
    text += as_string(one);
  }
  return text;
}

FileDescriptor paired_client(std::uint16_t port, const std::string& number) {
  const auto start = Clock::now();
  while (true) {
    FileDescriptor fd = connect_to(port, 10);
    const std::string request = "@@V2" + number + "FEFF";
    send_all(fd.get(), {reinterpret_cast<const std::uint8_t*>(request.data()), request.size()});
    const std::string reply = receive_until(fd.get(), "FEFF");
    if (reply == "@@0000FEFF") return fd;
    if (reply != "@@0001FEFF" || seconds_since(start) > 30)
      throw std::runtime_error("device " + number + ": " + reply);
    std::this_thread::sleep_for(std::chrono::milliseconds(50));
  }
}

ProgramBridge::ProgramBridge(const std::string& buses) {
  const std::string text =
      "bridge: bench\ndds: { domain: " + std::to_string(own_domain()) +
      " }\nprogram:\n  engineers: { listen: 127.0.0.1:" + std::to_string(engineers_) +
      " }\n  modules: { listen: 127.0.0.1:" + std::to_string(modules_) + " }\nbuses:\n" + buses;
  process_ = std::make_unique<Process>("fieldcast-bridge",
                                       std::vector<std::string>{folder_.write("plant.yaml", text)},
                                       folder_.path() + "/bridge.log");
  (void)connect_to(engineers_, 10);  // waits until the bridge runs
}

}  // namespace fieldcast::bench
