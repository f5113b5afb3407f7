#include "tools/cli/direct/line_exchange.hpp"

#include <unistd.h>

#include <algorithm>
#include <boost/asio/io_context.hpp>
#include <cerrno>
#include <ostream>
#include <utility>

#include "bridge/base/clock.hpp"
#include "bridge/port/port.hpp"
#include "tools/cli/terminal/interrupt.hpp"
#include "tools/cli/text/output.hpp"

namespace fieldcast::cli {

tl::expected<std::unique_ptr<LineCapture>, std::string> LineCapture::make(
    const std::string& path, const BusSpec& bus, const std::string& command) {
  auto file = CaptureFile::make(path);
  if (!file)
    return tl::unexpected(
        "--capture: " + file.error().text +
        (file.error().error == EEXIST ? "; a capture never overwrites a file" : ""));
  return std::unique_ptr<LineCapture>(new LineCapture(*std::move(file), bus, command));
}

LineCapture::LineCapture(CaptureFile file, const BusSpec& bus, const std::string& command)
    : file_(std::move(file)), capture_(bus, command, tap_) {
  counts_.begun = utc_now();
  append(capture_.head());
  capture_.add(*this);
}

LineCapture::~LineCapture() {
  (void)end();
  if (counts_.frames == 0) ::unlink(file_.path().c_str());
}

void LineCapture::write() { capture_.drain(utc_now()); }

std::optional<std::string> LineCapture::end() {
  if (!std::exchange(ended_, true)) {
    capture_.finish(utc_now());
    capture_.remove(*this);
    counts_.ended = utc_now();
    append(capture_tail(counts_));
  }
  return fault_.empty() ? std::nullopt : std::optional("--capture: " + fault_);
}

void LineCapture::packet(ByteView block, UtcTime, bool) {
  append(block);
  if (fault_.empty()) ++counts_.frames;
}

// Stops after the first failure, because later frames would leave a gap.
void LineCapture::append(ByteView blocks) {
  if (!fault_.empty()) return;
  if (const auto written = file_.append(blocks); !written)
    fault_ = written.error().text + "; what was captured before is whole";
}

ExitCode on_line(const std::string& path, const BusSpec& bus, const std::string& command,
                 std::ostream& err, const std::function<ExitCode(LineCapture* capture)>& work) {
  if (path.empty()) return work(nullptr);
  const std::string name = "fieldcast " + command;
  const auto capture = LineCapture::make(path, bus, name);
  if (!capture) {
    err << name << ": " << printable(capture.error()) << '\n';
    return ExitCode::kTrouble;
  }
  const ExitCode code = work(capture->get());
  const auto fault = (*capture)->end();
  if (!fault) return code;
  err << name << ": " << printable(*fault) << '\n';
  return code == ExitCode::kOk ? ExitCode::kTrouble : code;
}

namespace {

constexpr std::chrono::milliseconds kTalkCheck{50};
constexpr std::chrono::seconds kOpenLimit{5};
// A silence that ends a response; longer than gaps between the pieces of adapters.
constexpr std::chrono::milliseconds kGapAllowance{30};
// Limit of the bytes that are compared to detect an echo.
constexpr std::size_t kMostHeard = 4096;
// After this time the request is sent even if the line is not silent.
constexpr std::chrono::milliseconds kLongestStray{300};

}  // namespace

struct LineExchange::State final : PortListener {
  State(const Interrupt& given, std::shared_ptr<CaptureTap> into)
      : interrupt(given), tap(std::move(into)) {}

  void on_opened() override { opened = true; }
  void on_received(ByteView bytes, Instant arrival) override {
    last_byte = arrival;
    strays += bytes.size();
    if (heard.size() < kMostHeard) append(heard, bytes);
    record(CaptureRecord::Kind::kReceived, bytes, {}, arrival);
    if (!driver || !driver->active()) return;
    Bytes out;
    outcome = driver->on_bytes(bytes, arrival, out);
    again = std::move(out);
  }
  void on_closed(std::string reason, Cause) override { closed = std::move(reason); }

  void wait(Instant until) {
    const Duration rest = std::max<Duration>(until - steady_now(), Duration::zero());
    io.restart();
    (void)io.run_one_for(std::min<Duration>(rest, kTalkCheck));
    if (meanwhile) meanwhile();
  }
  void write(const Bytes& bytes, const LineEvent& note) {
    device = note.device;
    if (said.size() < kMostHeard) append(said, bytes);
    record(CaptureRecord::Kind::kSent, bytes, note.text, steady_now());
    port->write(bytes);
    if (driver->response_baud() != 0) port->receive_at(driver->response_baud(), bytes.size());
  }
  void record(CaptureRecord::Kind kind, ByteView bytes, const std::string& text, Instant at) const {
    if (tap && tap->wanted())
      tap->put({kind, read_clocks().to_utc(at), device, Bytes(bytes.begin(), bytes.end()), text});
  }
  [[nodiscard]] bool heard_others() const {
    return heard.size() > said.size() || !std::equal(heard.begin(), heard.end(), said.begin());
  }
  void record_end(const LineExchange::Response& response) const {
    if (response.cause != Cause::kNone)
      record(CaptureRecord::Kind::kRemark, {}, std::string(to_text(response.cause)), steady_now());
    record(CaptureRecord::Kind::kEnded, {}, {}, steady_now());
  }
  [[nodiscard]] std::string why_closed() const {
    return interrupt.raised() ? std::string() : closed.value_or("the port does not open");
  }

  const Interrupt& interrupt;
  const std::shared_ptr<CaptureTap> tap;  // null: no capture
  std::size_t device = 0;                 // requested device, for the capture
  std::function<void()> meanwhile;
  boost::asio::io_context io{1};
  std::unique_ptr<Port> port;
  std::optional<ExchangeDriver> driver;
  Duration silence{};
  bool opened = false;
  std::optional<std::string> closed;
  Instant last_byte = kLongAgo;
  std::size_t strays = 0;  // bytes since the last request
  Bytes heard, said;       // since listen_again()
  ExchangeDriver::Outcome outcome = ExchangeDriver::Outcome::kWaiting;
  Bytes again;  // next request of the exchange
};

LineExchange::LineExchange(const Interrupt& interrupt, std::shared_ptr<CaptureTap> tap)
    : state_(std::make_unique<State>(interrupt, std::move(tap))) {}

LineExchange::~LineExchange() { close(); }

void LineExchange::while_waiting(std::function<void()> meanwhile) {
  state_->meanwhile = std::move(meanwhile);
}

void LineExchange::listen_again() {
  state_->heard.clear();
  state_->said.clear();
}

void LineExchange::close() {
  if (state_->port) state_->port->close();
  state_->port.reset();
  state_->driver.reset();
}

void LineExchange::rest(Duration time) {
  const Instant until = steady_now() + time;
  while (!state_->closed && !state_->interrupt.raised() && steady_now() < until)
    state_->wait(until);
}

tl::expected<void, std::string> LineExchange::open(const PortSpec& spec) {
  close();
  State& state = *state_;
  state.opened = false;
  state.closed.reset();
  state.last_byte = kLongAgo;
  state.silence = silence_of(StandardSilence{}, line_of(spec));
  listen_again();
  state.driver.emplace(line_of(spec), kGapAllowance, Echo::kUnknown);
  state.port = make_port(state.io, spec);
  state.port->open(state);
  const Instant limit = steady_now() + kOpenLimit;
  while (!state.opened && !state.closed && !state.interrupt.raised() && steady_now() < limit)
    state.wait(limit);
  if (state.opened) {
    const bool serial = std::holds_alternative<SerialPortSpec>(spec);
    state.record(CaptureRecord::Kind::kRemark, {},
                 "the port is open" + (serial ? ": " + to_text(line_of(spec)) : std::string()),
                 steady_now());
    return {};
  }
  return tl::unexpected(state.why_closed());
}

tl::expected<LineExchange::Response, std::string> LineExchange::ask(
    std::unique_ptr<Exchange> exchange, Duration timeout, const LineEvent& note) {
  State& state = *state_;
  const Instant limit = steady_now() + kLongestStray;
  const auto silent_at = [&] {
    return state.last_byte == kLongAgo ? kLongAgo : state.last_byte + state.silence;
  };
  while (steady_now() < std::min(silent_at(), limit) && !state.closed && !state.interrupt.raised())
    state.wait(std::min(silent_at(), limit));

  Bytes out;
  state.strays = 0;
  state.outcome = ExchangeDriver::Outcome::kWaiting;
  state.driver->begin(std::move(exchange), timeout, EqualBytes::kEcho, steady_now(), out);
  state.write(out, note);
  while (state.driver->active() && !state.closed && !state.interrupt.raised()) {
    state.wait(state.driver->deadline());
    if (state.outcome == ExchangeDriver::Outcome::kWaiting &&
        steady_now() >= state.driver->deadline()) {
      state.port->poll();
      out.clear();
      if (state.outcome == ExchangeDriver::Outcome::kWaiting &&
          steady_now() >= state.driver->deadline()) {
        state.outcome = state.driver->on_timer(steady_now(), out);
        state.again = out;
      }
    }
    if (!state.again.empty()) state.write(std::exchange(state.again, {}), note);
    if (state.outcome == ExchangeDriver::Outcome::kSend)
      state.outcome = ExchangeDriver::Outcome::kWaiting;
    if (state.outcome != ExchangeDriver::Outcome::kWaiting) break;
  }
  if (state.closed || state.interrupt.raised()) {
    state.driver->abort();
    return tl::unexpected(state.why_closed());
  }
  Response response;
  response.bytes = state.strays;
  response.heard = state.heard_others();
  if (state.outcome == ExchangeDriver::Outcome::kDone) {
    response.took = state.driver->response_time();
    response.reply = state.driver->exchange().reply();
    for (const RangeReply& range : response.reply) {
      if (!range.absent.empty()) response.cause = Cause::kDeviceError;
    }
  } else {
    response.cause = state.driver->cause();
    response.device_code = state.driver->device_code();
    response.took = state.driver->response_time();
    response.echo_alone = state.driver->echo_alone();
    response.shape = response_shape(state.driver->raw_received(), state.driver->sent(),
                                    state.driver->expected());
  }
  (void)state.driver->finish();
  state.record_end(response);
  return response;
}

}  // namespace fieldcast::cli
