#include "tools/bench/support/stations.hpp"

#include <sys/socket.h>
#include <unistd.h>

#include <chrono>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <set>
#include <sstream>
#include <string>
#include <string_view>

#include "bridge/base/file_descriptor.hpp"
#include "tools/bench/plant/plant.hpp"

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
  std::string response;
  char piece[65536];
  for (ssize_t count = 0; (count = ::recv(fd.get(), piece, sizeof piece, 0)) > 0;)
    response.append(piece, static_cast<std::size_t>(count));
  return response.ends_with("# EOF\n") ? response : std::string{};
}

}  // namespace

Scraper::Scraper(std::uint16_t port) : port_(port), thread_([this] { run(); }) {}

Scraper::~Scraper() {
  ending_ = true;
  thread_.join();
}

void Scraper::run() {
  for (auto due = std::chrono::steady_clock::now(); !ending_; due += std::chrono::seconds{1}) {
    std::this_thread::sleep_until(due);
    if (const std::string response = scrape(port_); !response.empty()) {
      bytes_ = response.size();
      ++scrapes_;
    }
  }
}

StationProcess::StationProcess(const ScratchFolder& folder, unsigned domain,
                               const std::string& name, const std::string& way, double loss,
                               const std::string& program)
    : log_(folder.path() + '/' + name + ".log"),
      process_(program, {std::to_string(domain), way, std::to_string(loss)}, log_) {}

Received StationProcess::received() const {
  std::ifstream file(log_);
  Received received, line;
  std::string text;
  while (std::getline(file, text)) {
    std::istringstream numbers(text);
    if (numbers >> line.samples >> line.missing >> line.channels >> line.listed >>
        line.missing_blocks)
      received = line;
  }
  return received;
}

std::uint64_t dropped_datagrams() {
  std::ifstream file("/proc/net/snmp");
  std::string names, values;
  while (std::getline(file, names) && std::getline(file, values)) {
    if (!names.starts_with("Udp:")) continue;
    std::istringstream name(names), value(values);
    std::string one;
    std::string number;
    while (name >> one && value >> number) {
      if (one == "RcvbufErrors") return std::stoull(number);
    }
  }
  return 0;
}

std::uint64_t dropped_datagrams(pid_t process) {
  std::set<std::string> sockets;  // their inodes
  std::error_code ignored;        // files may close while they are listed
  const std::string of_process = "/proc/" + std::to_string(process);
  for (const auto& file : std::filesystem::directory_iterator(of_process + "/fd", ignored)) {
    const std::string target = std::filesystem::read_symlink(file.path(), ignored).string();
    if (target.starts_with("socket:[")) sockets.insert(target.substr(8, target.size() - 9));
  }
  std::ifstream file(of_process + "/net/udp");
  std::uint64_t dropped = 0;
  std::string line;
  std::getline(file, line);  // skips the heading
  while (std::getline(file, line)) {
    std::istringstream fields(line);
    const std::vector<std::string> words{std::istream_iterator<std::string>(fields), {}};
    // proc(5): inode is the tenth field, drops the last.
    if (words.size() > 10 && sockets.contains(words[9])) dropped += std::stoull(words.back());
  }
  return dropped;
}

}  // namespace fieldcast::bench
