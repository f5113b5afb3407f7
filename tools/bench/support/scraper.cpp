#include "tools/bench/support/scraper.hpp"

#include <sys/socket.h>
#include <unistd.h>

#include <chrono>
#include <stdexcept>
#include <string>
#include <string_view>

#include "bridge/base/file_descriptor.hpp"
#include "tools/bench/plant/loopback.hpp"

namespace fieldcast::bench {
namespace {

std::string scrape(std::uint16_t port) {
  static constexpr std::string_view kRequest =
      "GET /metrics HTTP/1.1\r\nHost: bridge\r\nConnection: close\r\n"
      "Accept: application/openmetrics-text; version=1.0.0\r\n\r\n";
  const FileDescriptor fd(::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0));
  const sockaddr_in address = loopback(port);
  if (::connect(fd.get(), reinterpret_cast<const sockaddr*>(&address), sizeof address) != 0)
    return {};
  if (::send(fd.get(), kRequest.data(), kRequest.size(), MSG_NOSIGNAL) < 0) return {};
  std::string answer;
  char piece[65536];
  for (ssize_t count = 0; (count = ::recv(fd.get(), piece, sizeof piece, 0)) > 0;)
    answer.append(piece, static_cast<std::size_t>(count));
  return answer.ends_with("# EOF\n") ? answer : std::string{};
}

}  // namespace

std::uint16_t free_tcp_port() {
  constexpr unsigned kLowest = 20000, kCount = 12000;  // below the kernel's ephemeral ports
  for (unsigned i = 0; i < kCount; ++i) {
    const auto port =
        static_cast<std::uint16_t>(kLowest + (static_cast<unsigned>(::getpid()) * 7 + i) % kCount);
    const FileDescriptor fd(::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0));
    const sockaddr_in address = loopback(port);
    if (::bind(fd.get(), reinterpret_cast<const sockaddr*>(&address), sizeof address) == 0)
      return port;
  }
  throw std::runtime_error("every port from 20000 to 31999 is taken");
}

Scraper::Scraper(std::uint16_t port) : port_(port), thread_([this] { run(); }) {}

Scraper::~Scraper() {
  ending_ = true;
  thread_.join();
}

void Scraper::run() {
  for (auto due = std::chrono::steady_clock::now(); !ending_; due += std::chrono::seconds{1}) {
    std::this_thread::sleep_until(due);
    if (const std::string answer = scrape(port_); !answer.empty()) {
      bytes_ = answer.size();
      ++scrapes_;
    }
  }
}

}  // namespace fieldcast::bench
