#include "tools/bench/support/program_net.hpp"

#include <arpa/inet.h>
#include <fcntl.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <pty.h>
#include <sys/socket.h>
#include <termios.h>

#include <array>
#include <atomic>
#include <cerrno>
#include <deque>
#include <stdexcept>
#include <thread>
#include <utility>

#include "bridge/base/file_descriptor.hpp"
#include "tools/bench/plant/plant.hpp"
#include "tools/bench/support/figures.hpp"

namespace fieldcast::bench {

namespace {

std::string as_string(const Bytes& bytes) { return {bytes.begin(), bytes.end()}; }

}  // namespace

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

// Transfers one megabyte of requests and responses over a line of 115200 7E2: directly over a
// pseudo-terminal pair, and through fieldcast-port, a network with a delay, the bridge and a
// module. The simulated PLC is the same in both and uses the wire time of every character. Both run
// concurrently, because they nearly always sleep.
namespace {

constexpr double kCharacter = 11.0 / 115200;  // 7E2: start, seven bits, parity, two stops
// Like a program upload: 0306 for 512 bytes, response in hexadecimal digits (FINS).
constexpr std::size_t kRequest = 38, kResponse = 1067;
constexpr std::size_t kPiece = 64;  // characters of one piece of a module or UART

void wait_for_line(Clock::time_point& line, std::size_t characters) {
  line = std::max(line, Clock::now()) +
         std::chrono::duration_cast<Clock::duration>(
             std::chrono::duration<double>(kCharacter * static_cast<double>(characters)));
  std::this_thread::sleep_until(line);
}

void serve_as_plc(int fd) {
  Bytes response(kResponse, '5');
  response.back() = '\r';
  std::size_t received = 0;
  Clock::time_point line{};
  while (true) {
    const Bytes bytes = receive_some(fd, 4096);
    if (bytes.empty()) return;
    received += bytes.size();
    if (bytes.back() != '\r') continue;
    wait_for_line(line, std::exchange(received, 0));
    for (std::size_t at = 0; at < response.size(); at += kPiece) {
      const std::size_t count = std::min(kPiece, response.size() - at);
      wait_for_line(line, count);
      send_all(fd, ByteView(response).subspan(at, count));
    }
  }
}

double run_software(int fd, double bytes) {
  Bytes request(kRequest, '0');
  request.back() = '\r';
  const int exchanges =
      std::max(3, static_cast<int>(bytes / static_cast<double>(kRequest + kResponse)));
  const auto start = Clock::now();
  for (int i = 0; i < exchanges; ++i) {
    send_all(fd, request);
    for (std::size_t received = 0; received < kResponse;) {
      const Bytes part = receive_some(fd, 4096);
      if (part.empty()) throw std::runtime_error("the line ended");
      received += part.size();
    }
  }
  return seconds_since(start) / exchanges;
}

struct Terminals {
  Terminals() {
    int m = -1, s = -1;
    termios raw{};
    ::cfmakeraw(&raw);
    if (::openpty(&m, &s, nullptr, &raw, nullptr) != 0)
      throw std::runtime_error("no pseudo-terminal");
    master.reset(m);
    slave.reset(s);
  }
  FileDescriptor master, slave;
};

double direct(double bytes) {
  Terminals terminals;
  std::thread plc([fd = terminals.master.get()] { serve_as_plc(fd); });
  const double took = run_software(terminals.slave.get(), bytes);
  terminals.slave.reset();  // then the read of the master ends
  plc.join();
  return took;
}

// Delays each byte by half the delay, in both directions.
class DelayingProxy {
 public:
  DelayingProxy(std::uint16_t target, double delay)
      : delay_(delay / 2),
        listener_(::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0)),
        port_(free_port()) {
    const sockaddr_in address = loopback(port_);
    const int on = 1;
    ::setsockopt(listener_.get(), SOL_SOCKET, SO_REUSEADDR, &on, sizeof on);
    if (::bind(listener_.get(), reinterpret_cast<const sockaddr*>(&address), sizeof address) != 0 ||
        ::listen(listener_.get(), 1) != 0)
      throw std::runtime_error("the proxy cannot listen");
    thread_ = std::thread([this, target] { carry(target); });
  }
  ~DelayingProxy() {
    over_ = true;
    thread_.join();
  }
  [[nodiscard]] std::uint16_t port() const { return port_; }

 private:
  struct Way {
    int from, to;
    std::deque<std::pair<Clock::time_point, Bytes>> late{};
  };

  void carry(std::uint16_t target) {
    const FileDescriptor client(::accept4(listener_.get(), nullptr, nullptr, SOCK_CLOEXEC));
    const FileDescriptor server = connect_to(target, 5);
    std::array<Way, 2> ways{Way{client.get(), server.get()}, Way{server.get(), client.get()}};
    const auto delay =
        std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(delay_));
    const int on = 1;
    ::setsockopt(client.get(), IPPROTO_TCP, TCP_NODELAY, &on, sizeof on);
    while (!over_) {
      auto wake = Clock::now() + std::chrono::milliseconds(100);
      for (const Way& way : ways) {
        if (!way.late.empty()) wake = std::min(wake, way.late.front().first);
      }
      const auto left = std::max(wake - Clock::now(), Clock::duration::zero());
      const timespec limit{std::chrono::duration_cast<std::chrono::seconds>(left).count(),
                           (left % std::chrono::seconds(1)).count()};
      std::array<pollfd, 2> wait{pollfd{ways[0].from, POLLIN, 0}, pollfd{ways[1].from, POLLIN, 0}};
      ::ppoll(wait.data(), wait.size(), &limit, nullptr);
      for (std::size_t i = 0; i < ways.size(); ++i) {
        if (wait[i].revents != 0) {
          Bytes bytes = receive_some(ways[i].from, 65536);
          if (bytes.empty()) return;
          ways[i].late.emplace_back(Clock::now() + delay, std::move(bytes));
        }
        while (!ways[i].late.empty() && ways[i].late.front().first <= Clock::now()) {
          send_all(ways[i].to, ways[i].late.front().second);
          ways[i].late.pop_front();
        }
      }
    }
  }

  double delay_;
  FileDescriptor listener_;
  std::uint16_t port_;
  std::atomic<bool> over_{false};
  std::thread thread_;
};

double through(const ExchangeOptions& options) {
  ProgramBridge bridge(
      "  - { name: other, port: { serial: " + std::string("/nowhere") +
      " }, protocol: modbus-rtu, devices: [ { name: d, address: 1, allow: [raw-read] } ] }\n");
  FileDescriptor module = connect_to(bridge.modules(), 5);
  send_all(module.get(), Bytes{'1', '7', '\n'});
  paired_client(bridge.engineers(), "17").reset();  // the module is registered now
  std::thread plc([fd = module.get()] { serve_as_plc(fd); });
  const std::string link = bridge.folder().path() + "/plc";
  double took = 0;
  {
    DelayingProxy proxy(bridge.engineers(), options.delay_ms / 1000);
    std::vector<std::string> arguments{
        "--server", "127.0.0.1:" + std::to_string(proxy.port()), "--device", "17", "--link", link};
    if (options.markers) arguments.push_back("--markers");
    const std::string log = bridge.folder().path() + "/port.log";
    Process port("fieldcast-port", arguments, log);
    if (!wait_for_text(log, "paired", 20)) throw std::runtime_error("fieldcast-port is not paired");
    FileDescriptor software(::open(link.c_str(), O_RDWR | O_NOCTTY | O_CLOEXEC));
    if (!software.valid()) throw std::runtime_error("the virtual port does not open");
    took = run_software(software.get(), options.bytes);
    software.reset();
    port.stop();
  }
  ::shutdown(module.get(), SHUT_RDWR);
  plc.join();
  return took;
}

}  // namespace

void exchange_bench(const ExchangeOptions& options) {
  double alone = 0;
  std::thread beside([&] { alone = direct(options.bytes); });
  const double took = through(options);
  beside.join();
  const double ideal = alone + options.delay_ms / 1000;
  print_figure("exchange directly over a terminal pair", alone * 1e3, "ms");
  print_figure("exchange through port, network, bridge and module", took * 1e3, "ms");
  print_figure("delay added to each round trip", options.delay_ms, "ms");
  print_figure("rate against what request and response allow", 100 * ideal / took, "%",
               options.delay_ms > 0 ? ">= 95" : ">= 97");
}

}  // namespace fieldcast::bench
