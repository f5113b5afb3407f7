// fieldcast replay: repeats the requests of a recorded programming session at a line, and compares
// the responses with the recorded ones.
#include <fmt/format.h>

#include <cerrno>
#include <fstream>
#include <ostream>

#include "bridge/base/file_descriptor.hpp"
#include "core/capture/capture_record.hpp"
#include "tools/cli/command/base/command_run.hpp"
#include "tools/cli/direct/direct_bus.hpp"
#include "tools/cli/direct/line_exchange.hpp"
#include "tools/cli/inspect/frame_report.hpp"

namespace fieldcast::cli {
namespace {

struct ReplayOptions {
  std::string capture;
  LineOptions line;
};

constexpr std::size_t kShown = 10;  // differences

struct RecordedRequest {
  Bytes request, response;  // no response: the device sent none
};

// Sends recorded bytes and takes as many as the recorded response has.
class Repetition final : public Exchange {
 public:
  explicit Repetition(const RecordedRequest& step) : step_(step) {}

  Step start(Bytes& out) override {
    out = step_.request;
    if (step_.response.empty()) return Step::send_without_response(kQuiet);
    return Step::send(step_.response.size());
  }
  Step on_bytes(ByteView all, Bytes&) override {
    reply_.assign(1, {.items = Bytes(all.begin(), all.end())});
    if (step_.response.empty()) return Step::pause_for(kQuiet);
    if (all.size() >= step_.response.size()) return Step::done();
    return Step::need_rest(step_.response.size() - all.size());
  }
  Step on_silence(Bytes&) override { return Step::done(); }
  const Reply& reply() const override { return reply_; }

 private:
  static constexpr Duration kQuiet = std::chrono::milliseconds{50};
  const RecordedRequest& step_;
  Reply reply_{RangeReply{}};
};

// The requests of sessions, each with its response; an error is one line.
tl::expected<std::vector<RecordedRequest>, std::string> recorded(const std::string& path) {
  std::ifstream in(path, std::ios::binary);
  if (!in) return tl::unexpected(fmt::format("{}: {}", path, errno_text(errno)));
  std::vector<RecordedRequest> steps;
  bool session = false;
  const CaptureEnd end = read_capture(in, [&](const SeenFrame& frame) {
    if (frame.comment.ends_with(kEchoComment)) return;
    if (frame.direction == Direction::kSent) {
      session = frame.comment.find(kSessionComment) != std::string::npos;
      if (session) steps.push_back({frame.bytes, {}});
    } else if (session) {
      append(steps.back().response, frame.bytes);
    }
  });
  if (end.fault) return tl::unexpected(fmt::format("{} {}", path, to_text(*end.fault)));
  if (end.dropped > 0)
    return tl::unexpected(
        fmt::format("{}: {} pieces of the session are missing", path, end.dropped));
  if (steps.empty()) return tl::unexpected(path + ": no programming session");
  return steps;
}

std::string shown(ByteView bytes) {
  constexpr std::size_t kMost = 40;
  if (bytes.empty()) return "nothing";
  return to_hex(bytes.first(std::min(bytes.size(), kMost))) + (bytes.size() > kMost ? " .." : "");
}

ExitCode replay(const ReplayOptions& options, const Interrupt& interrupt, const Streams& to) {
  const auto port = port_of(options.line, {115200, 7, Parity::kEven, 2});
  if (!port) return usage_fault(to.err, "replay", port.error());
  const auto steps = recorded(options.capture);
  if (!steps) return usage_fault(to.err, "replay", printable(steps.error()));
  LineExchange line(interrupt);
  const auto failed = [&](const std::string& reason) {
    if (reason.empty()) return ExitCode::kInterrupted;
    to.err << "fieldcast replay: " << printable(reason) << '\n';
    return ExitCode::kTrouble;
  };
  if (const auto opened = line.open(*port); !opened) return failed(opened.error());
  std::size_t differences = 0, number = 0;
  for (const RecordedRequest& step : *steps) {
    ++number;
    const auto response = line.ask(std::make_unique<Repetition>(step), options.line.timeout);
    if (!response) return failed(response.error());
    if (response->reply.empty())
      return failed(fmt::format("request {}: the line sent more than {} bytes", number,
                                ExchangeDriver::kMaxReceived));
    const Bytes& items = response->reply.front().items;
    if (items == step.response) continue;
    if (++differences > kShown) continue;
    to.out << fmt::format("request {}: {}\n  recorded  {}\n  received  {}\n", number,
                          shown(step.request), shown(step.response), shown(items));
  }
  to.out << fmt::format("{} requests, {} with another response\n", steps->size(), differences);
  return differences == 0 ? ExitCode::kOk : ExitCode::kFound;
}

void describe_replay(CommandLine& line, ReplayOptions& options) {
  line.text("CAPTURE", options.capture, "A capture with a programming session (x.pcapng)")
      .required();
  line.text("PORT", options.line.port,
            "The line: /dev/ttyUSB0, HOST:PORT, rfc2217:HOST:PORT. Programming software may change "
            "the program of what is there: use a simulated PLC, or a spare one")
      .required();
  line.number("--baud", options.line.baud, kLowestBaud, kHighestBaud, "Of a serial line (115200)");
  line.text("--format", options.line.format, "Of a serial line (7E2)");
  line.duration("--timeout", options.line.timeout, CommandLine::kShortest,
                "Until the first byte of a response (500ms)");
}

}  // namespace

CommandRow replay_command() {
  return command_row("replay", "Repeat a recorded programming session at a line, and compare",
                     describe_replay, interruptible(replay));
}

}  // namespace fieldcast::cli
