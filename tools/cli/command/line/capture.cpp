#include <fmt/format.h>
#include <fmt/ranges.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <charconv>
#include <optional>
#include <ostream>
#include <string>

#include "bridge/base/clock.hpp"
#include "bridge/base/file_descriptor.hpp"
#include "bridge/capture/capture_ring.hpp"
#include "core/base/message_text.hpp"
#include "core/capture/pcapng.hpp"
#include "tools/cli/capture/capture_stream.hpp"
#include "tools/cli/command/base/command_run.hpp"
#include "tools/progress/progress_line.hpp"

namespace fieldcast::cli {
namespace {

constexpr int kLookMilliseconds = 50;  // interval of checks for Ctrl-C and the end time
// time to receive the rest after the end was requested
constexpr Duration kLastBlocks = std::chrono::seconds{2};
constexpr std::size_t kTail = 512;  // reserve for the end of the file

using Fault = CaptureFile::Fault;

struct CaptureOptions {
  std::string bus;
  std::string out;     // "-": standard output
  std::string bridge;  // needed if several bridges have a bus of this name; else empty
  std::optional<Duration> time;
  std::uint64_t size = 0;  // maximum file size in bytes; 0: no limit
};

class CaptureOut {
 public:
  [[nodiscard]] static tl::expected<CaptureOut, Fault> open(const std::string& path) {
    if (path == "-") return CaptureOut({});
    auto made = CaptureFile::make(path);
    if (!made) return tl::unexpected(made.error());
    return CaptureOut(*std::move(made));
  }
  [[nodiscard]] tl::expected<void, Fault> append(ByteView blocks) {
    size_ += blocks.size();
    if (file_) return file_->append(blocks);
    for (std::size_t written = 0; written < blocks.size();) {
      const auto wrote = ::write(STDOUT_FILENO, blocks.data() + written, blocks.size() - written);
      if (wrote < 0 && errno == EINTR) continue;
      if (wrote <= 0) return tl::unexpected(Fault{errno, "standard output: " + errno_text(errno)});
      written += static_cast<std::size_t>(wrote);
    }
    return {};
  }
  [[nodiscard]] std::uint64_t size() const { return size_; }
  void discard() const {
    if (file_) ::unlink(file_->path().c_str());
  }

 private:
  explicit CaptureOut(std::optional<CaptureFile> file) : file_(std::move(file)) {}
  std::optional<CaptureFile> file_;
  std::uint64_t size_ = 0;
};

tl::expected<FoundBridge, ExitCode> choose(const CaptureOptions& options, std::ostream& err) {
  Bridges bridges = find_bridges();
  if (!options.bridge.empty())
    std::erase_if(bridges.found,
                  [&](const FoundBridge& each) { return each.name != options.bridge; });
  std::vector<std::string> buses;
  std::vector<FoundBridge> fitting;
  for (FoundBridge& bridge : bridges.found) {
    buses.insert(buses.end(), bridge.buses.begin(), bridge.buses.end());
    if (std::ranges::find(bridge.buses, options.bus) != bridge.buses.end())
      fitting.push_back(std::move(bridge));
  }
  if (fitting.size() == 1) return std::move(fitting.front());
  if (fitting.size() > 1) {
    err << fmt::format("fieldcast capture: {} bridges have a bus {}; choose one with --bridge\n",
                       fitting.size(), printable(options.bus));
    return tl::unexpected(ExitCode::kUsage);
  }
  if (!bridges.found.empty()) {
    err << fmt::format("fieldcast capture: no bus {}; there is {}\n", printable(options.bus),
                       printable(fmt::format("{}", fmt::join(buses, ", "))));
    return tl::unexpected(ExitCode::kNothing);
  }
  err << "fieldcast capture: "
      << (bridges.refused.empty()
              ? std::string("no bridge runs on this machine; a capture is made where the bridge is")
              : fmt::format("{} belongs to another user; capture as that user or as root",
                            printable(fmt::format("{}", fmt::join(bridges.refused, ", ")))))
      << '\n';
  return tl::unexpected(ExitCode::kNoBridge);
}

class Capturing {
 public:
  Capturing(const CaptureOptions& options, const Interrupt& interrupt, FileDescriptor socket,
            CaptureOut out, std::ostream& err)
      : options_(options),
        interrupt_(interrupt),
        socket_(std::move(socket)),
        out_(std::move(out)),
        err_(err),
        progress_(err) {}

  ExitCode run() {
    while (!over_) {
      pollfd ready{socket_.get(), POLLIN, 0};
      const int found = ::poll(&ready, 1, kLookMilliseconds);
      if (found > 0 && !take()) break;
      look(steady_now());
    }
    return verdict();
  }

 private:
  // Returns false at the end of the stream.
  bool take() {
    buffer_.resize(65536);
    const auto got = ::recv(socket_.get(), buffer_.data(), buffer_.size(), MSG_DONTWAIT);
    if (got < 0 && (errno == EINTR || errno == EAGAIN)) return true;
    if (got <= 0) return false;
    for (const auto& block : cutter_.take(ByteView(buffer_).first(static_cast<std::size_t>(got)))) {
      if (!write(block)) return false;
    }
    return !cutter_.broken();
  }

  bool write(const BlockCutter::Block& block) {
    const bool packet = block.type == pcapng::kEnhancedPacket;
    full_ |=
        packet && options_.size > 0 && out_.size() + block.bytes.size() + kTail > options_.size;
    if (packet && full_) return true;
    if (const auto written = out_.append(block.bytes); !written) {
      fault_ = written.error().text;
      return false;
    }
    if (packet) ++frames_;
    ended_ |= block.type == pcapng::kInterfaceStatistics;
    return true;
  }

  void look(Instant now) {
    const bool over = options_.time && now - begun_ >= *options_.time;
    if (!asked_end_ && (over || full_ || interrupt_.raised())) {
      ::shutdown(socket_.get(), SHUT_WR);  // requests the end from the bridge
      asked_end_ = now;
    }
    over_ = asked_end_ && now - *asked_end_ > kLastBlocks;
    progress_.show([&](Duration) { return progress(now); });
  }

  [[nodiscard]] ProgressText progress(Instant now) const {
    const Duration elapsed = now - begun_;
    const std::string so_far =
        fmt::format("{}, {} kB", counted(frames_, "frame", "frames"), out_.size() / 1000);
    if (!options_.time)
      return {"capturing " + options_.bus,
              fmt::format("{:.0f}s, {}; Ctrl-C ends", to_seconds(elapsed), so_far)};
    ProgressText text = progress_text("capturing " + options_.bus,
                                      to_seconds(elapsed) / to_seconds(*options_.time), elapsed);
    text.how_far += fmt::format(", {}; Ctrl-C ends", so_far);
    return text;
  }

  ExitCode verdict() {
    progress_.clear();
    const std::string what =
        fmt::format("{} of {}", counted(frames_, "frame", "frames"), printable(options_.bus));
    if (!fault_.empty()) {
      err_ << fmt::format(
          "fieldcast capture: stopped: {}; what was captured before is whole ({})\n",
          printable(fault_), what);
      return ExitCode::kTrouble;
    }
    if (out_.size() == 0) out_.discard();
    if (!ended_) {
      err_ << fmt::format(
          "fieldcast capture: the bridge was lost; what came before is whole ({})\n", what);
      return ExitCode::kTrouble;
    }
    err_ << fmt::format("fieldcast capture: {}{}\n", what,
                        asked_end_ ? "" : "; the bridge or the bus ended");
    return ExitCode::kOk;
  }

  const CaptureOptions& options_;
  const Interrupt& interrupt_;
  FileDescriptor socket_;
  CaptureOut out_;
  std::ostream& err_;
  ProgressLine progress_;
  BlockCutter cutter_;
  Bytes buffer_;
  const Instant begun_ = steady_now();
  std::optional<Instant> asked_end_;
  std::string fault_;
  std::uint64_t frames_ = 0;  // written
  bool ended_ = false;        // the last block arrived
  bool full_ = false, over_ = false;
};

// "250kB", "10MB", "1GB", "5000"; 0 for other text.
std::uint64_t bytes_from(const std::string& text) {
  std::uint64_t number = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  const std::string_view unit(end, static_cast<std::size_t>(text.data() + text.size() - end));
  std::uint64_t worth = 1;
  if (unit == "kB") worth = 1'000;
  if (unit == "MB") worth = 1'000'000;
  if (unit == "GB") worth = 1'000'000'000;
  if (error != std::errc{} || (worth == 1 && !unit.empty())) return 0;
  return number > UINT64_MAX / worth ? 0 : number * worth;
}

// kOk also after Ctrl-C. kNoBridge, kNothing: no such bus. kTrouble: the file cannot be written or
// the bridge was lost; earlier blocks are complete.
ExitCode capture(const CaptureOptions& options, const Interrupt& interrupt, const Streams& to) {
  std::ostream& err = to.err;
  const auto bridge = choose(options, err);
  if (!bridge) return bridge.error();
  auto out = CaptureOut::open(options.out);
  if (!out) {
    err << "fieldcast capture: " << printable(out.error().text)
        << (out.error().error == EEXIST ? "; a capture never overwrites a file" : "") << '\n';
    return ExitCode::kTrouble;
  }
  auto socket = ask_for_capture(bridge->socket, options.bus);
  if (!socket) {
    out->discard();
    err << "fieldcast capture: " << printable(socket.error()) << '\n';
    return ExitCode::kTrouble;
  }
  return Capturing(options, interrupt, *std::move(socket), *std::move(out), err).run();
}

constexpr std::uint64_t kLeastCapture = 10'000;

void describe_capture(CommandLine& line, CaptureOptions& options) {
  line.text("BUS", options.bus, "A bus of a bridge that runs on this machine").required();
  line.text("--out", options.out, "The file to make, readable for you only; - is standard output")
      .required();
  line.duration("--seconds,--for", options.time, CommandLine::kShortest,
                "End after this time (20, 500ms, 2min); else with Ctrl-C");
  line.value(
      "--size",
      [&options](const std::string& text) -> std::optional<std::string> {
        options.size = bytes_from(text);
        if (options.size >= kLeastCapture) return std::nullopt;
        return "allowed: 10kB or more, with kB, MB or GB";
      },
      "End before the file is larger than this (250kB, 10MB)");
  line.text("--bridge", options.bridge, "Where several bridges have a bus of this name");
}

}  // namespace

CommandRow capture_command() {
  return command_row("capture", "Write what passes on a bus to a file for Wireshark",
                     describe_capture, interruptible(capture));
}

}  // namespace fieldcast::cli
