// Sends random bytes in both directions through the bridge, optionally through fieldcast-port;
// compares every byte and checks the memory.
#include <fcntl.h>
#include <poll.h>
#include <sys/socket.h>
#include <termios.h>

#include <atomic>
#include <iostream>
#include <thread>

#include "tools/bench/support/figures.hpp"
#include "tools/bench/support/program_net.hpp"
#include "tools/progress/progress_line.hpp"

namespace fieldcast::bench {
namespace {

constexpr std::size_t kPiece = 64 * 1024;

// Deterministic bytes for a seed, eight at a time (xorshift64*, Vigna 2016).
class Stream {
 public:
  explicit Stream(std::uint64_t seed) : state_(seed) {}
  void fill(Bytes& out) {
    for (std::size_t i = 0; i < out.size(); i += 8) {
      const std::uint64_t word = next();
      for (std::size_t b = 0; b < 8 && i + b < out.size(); ++b)
        out[i + b] = static_cast<std::uint8_t>(word >> (8 * b));
    }
  }

 private:
  std::uint64_t next() {
    state_ ^= state_ >> 12;
    state_ ^= state_ << 25;
    state_ ^= state_ >> 27;
    return state_ * 2685821657736338717ull;
  }
  std::uint64_t state_;
};

// Sends `total` bytes of the stream, with length prefixes if `framed`.
void produce(int fd, std::uint64_t seed, std::uint64_t total, bool framed) {
  Stream stream(seed);
  Bytes piece(kPiece), out;
  for (std::uint64_t sent = 0; sent < total; sent += piece.size()) {
    stream.fill(piece);
    out.clear();
    if (framed) append_u32(out, static_cast<std::uint32_t>(piece.size()));
    append(out, piece);
    send_all(fd, out);
  }
}

class Unframed {
 public:
  void take(ByteView bytes, Bytes& out) {
    while (!bytes.empty()) {
      if (left_ > 0) {
        const std::size_t count = std::min<std::size_t>(left_, bytes.size());
        append(out, bytes.first(count));
        bytes = bytes.subspan(count);
        left_ -= static_cast<std::uint32_t>(count);
        continue;
      }
      head_.push_back(bytes.front());
      bytes = bytes.subspan(1);
      if (head_.size() < 4) continue;
      left_ = read_u32(head_);
      head_.clear();
    }
  }

 private:
  Bytes head_;
  std::uint32_t left_ = 0;
};

std::uint64_t compare(int fd, std::uint64_t seed, std::uint64_t total, bool framed,
                      std::atomic<std::uint64_t>& so_far) {
  Stream stream(seed);
  Bytes expected(kPiece), got;
  Unframed unframed;
  std::uint64_t right = 0;
  std::size_t at = expected.size();
  while (right < total) {
    const Bytes raw = receive_some(fd, kPiece);
    if (raw.empty()) return right;
    got.clear();
    if (framed) {
      unframed.take(raw, got);
    } else {
      got = raw;
    }
    for (std::size_t i = 0; i < got.size();) {
      if (at == expected.size()) stream.fill(expected), at = 0;
      const std::size_t count = std::min(expected.size() - at, got.size() - i);
      if (!std::equal(expected.begin() + static_cast<std::ptrdiff_t>(at),
                      expected.begin() + static_cast<std::ptrdiff_t>(at + count),
                      got.begin() + static_cast<std::ptrdiff_t>(i)))
        return right;
      at += count;
      i += count;
      right += count;
    }
    so_far = right;
  }
  return right;
}

FileDescriptor open_raw(const std::string& path) {
  FileDescriptor fd(::open(path.c_str(), O_RDWR | O_NOCTTY | O_CLOEXEC));
  termios settings{};
  if (!fd.valid() || ::tcgetattr(fd.get(), &settings) != 0)
    throw std::runtime_error("the virtual port does not open");
  ::cfmakeraw(&settings);
  ::tcsetattr(fd.get(), TCSANOW, &settings);
  return fd;
}

}  // namespace

void relay_bench(const RelayOptions& options) {
  ProgramBridge bridge(
      "  - { name: other, port: { serial: /nowhere }, protocol: modbus-rtu, devices: [ { name: d, "
      "address: 1, allow: [raw-read] } ] }\n");
  FileDescriptor module = connect_to(bridge.modules(), 5);
  send_all(module.get(), Bytes{'1', '7', '\n'});
  FileDescriptor engineer = paired_client(bridge.engineers(), "17");
  std::unique_ptr<Process> port;
  if (options.terminal) {
    engineer.reset();
    const std::string link = bridge.folder().path() + "/plc",
                      log = bridge.folder().path() + "/port.log";
    for (int attempt = 0; attempt < 20;
         ++attempt) {  // the bridge needs time to end the bench's own pairing
      port = std::make_unique<Process>(
          "fieldcast-port",
          std::vector<std::string>{"--server", "127.0.0.1:" + std::to_string(bridge.engineers()),
                                   "--device", "17", "--link", link},
          log);
      if (wait_for_text(log, "paired", 1)) break;
    }
    engineer = open_raw(link);
  }
  const bool framed = !options.terminal;
  const auto total = static_cast<std::uint64_t>(options.gigabytes * 1e9) / kPiece * kPiece;
  std::atomic<std::uint64_t> down{0}, up{0}, down_so_far{0}, up_so_far{0};
  const auto start = Clock::now();
  std::thread threads[] = {
      std::thread([&] { produce(engineer.get(), 1, total, framed); }),
      std::thread([&] { down = compare(module.get(), 1, total, false, down_so_far); }),
      std::thread([&] { produce(module.get(), 2, total, false); }),
      std::thread([&] { up = compare(engineer.get(), 2, total, framed, up_so_far); })};
  double early = 0, highest = 0, port_highest = 0;
  ProgressLine progress(std::cerr);
  while ((down < total || up < total) && seconds_since(start) < 3600) {
    std::this_thread::sleep_for(std::chrono::milliseconds(200));
    if (early == 0 && seconds_since(start) > 1) early = bridge.process().resident_mb();
    highest = std::max(highest, bridge.process().resident_mb());
    if (port) port_highest = std::max(port_highest, port->resident_mb());
    if (down > 0 && up > 0) break;  // each is set once, at the end of its stream
    progress.show([&](Duration elapsed) {
      const auto sum = static_cast<double>(down_so_far + up_so_far);
      return progress_text("both ways", sum / 2 / static_cast<double>(total), elapsed);
    });
  }
  progress.clear();
  for (std::thread& thread : threads) thread.join();
  const double took = seconds_since(start);
  print_figure("bytes to the device that came right", down.load(), "",
               std::to_string(total).c_str());
  print_figure("bytes from the device that came right", up.load(), "",
               std::to_string(total).c_str());
  print_figure("rate in each direction", static_cast<double>(total) / took / 1e6, "MB/s");
  print_figure("bridge: memory after a second", early, "MB");
  print_figure("bridge: highest memory", highest, "MB", "constant");
  if (port) print_figure("fieldcast-port: highest memory", port_highest, "MB", "constant");
}

}  // namespace fieldcast::bench
