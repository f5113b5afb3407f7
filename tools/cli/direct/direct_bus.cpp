#include "tools/cli/direct/direct_bus.hpp"

#include <condition_variable>
#include <mutex>

#include "bridge/base/io_thread.hpp"
#include "bridge/bus/bus_runner.hpp"
#include "bridge/bus/bus_sink.hpp"
#include "bridge/log/log.hpp"
#include "core/model/port_spec.hpp"
#include "tools/cli/direct/line_capture.hpp"

namespace fieldcast::cli {
namespace {

constexpr std::chrono::milliseconds kInterruptCheck{50};
constexpr std::chrono::milliseconds kTraceFlush{200};
constexpr std::chrono::hours kResultLimit{24};  // the engine completes every command long before

class Results final : public BusSink {
 public:
  struct Heard {
    bool running = false;
    std::string closed;  // why the port closed; empty: it is open
    std::optional<CommandResult> result;
  };

  // Empty after `limit` or an interrupt. Calls `meanwhile` regularly.
  template <class Enough, class Meanwhile>
  std::optional<Heard> wait(const Interrupt& interrupt, Duration limit, const Enough& enough,
                            const Meanwhile& meanwhile) {
    const auto end = std::chrono::steady_clock::now() + limit;
    std::unique_lock lock(mutex_);
    while (!enough(heard_)) {
      if (interrupt.raised() || std::chrono::steady_clock::now() >= end) return std::nullopt;
      changed_.wait_for(lock, kInterruptCheck);
      lock.unlock();
      meanwhile();
      lock.lock();
    }
    return heard_;
  }
  void forget_result() {
    change([](Heard& heard) { heard.result.reset(); });
  }

  void complete(const CommandResult& result, const UtcMapping&) override {
    change([&](Heard& heard) { heard.result = result; });
  }
  void report(const BusReport& report, UtcTime) override {
    change([&](Heard& heard) {
      heard.running = report.state == BusState::kRunning;
      heard.closed =
          report.closed_because == Cause::kNone ? "" : std::string(to_text(report.closed_because));
    });
  }
  void publish(std::vector<Sample>, const UtcMapping&) override {}
  void promise(ChannelIndex, std::optional<Duration>) override {}
  void report(std::string_view, const DeviceReport&, UtcTime) override {}
  void report(PlanReport, UtcTime) override {}

 private:
  template <class Change>
  void change(const Change& what) {
    const std::lock_guard lock(mutex_);
    what(heard_);
    changed_.notify_all();
  }

  std::mutex mutex_;
  std::condition_variable changed_;
  Heard heard_;
};

}  // namespace

struct DirectBus::State {
  State(const BusSpec& bus, bool trace, LineCapture* given)
      : port(name_of(bus.port)),
        capture(given),
        runner(io.context(), plans.context(), bus, results) {
    open_log(LogLevel::kWarning);
    runner.set_trace(trace);
    if (capture != nullptr) runner.set_capture(capture->tap());
    runner.start();
  }
  ~State() { (void)runner.stop().wait_for(std::chrono::seconds{2}); }

  void write_capture() const {
    if (capture != nullptr) capture->write();
  }

  const std::string port;
  LineCapture* const capture;
  std::uint64_t commands = 0;
  Results results;
  IoThread io{"line"};
  IoThread plans{"plans"};
  BusRunner runner;
};

DirectBus::DirectBus(const BusSpec& bus, bool trace, LineCapture* capture)
    : state_(std::make_unique<State>(bus, trace, capture)) {}

DirectBus::~DirectBus() {
  state_.reset();
  flush_log(kTraceFlush);
}

tl::expected<void, std::string> DirectBus::open(const Interrupt& interrupt) {
  const auto known = [](const Results::Heard& heard) {
    return heard.running || !heard.closed.empty();
  };
  const auto heard =
      state_->results.wait(interrupt, kOpenLimit, known, [this] { state_->write_capture(); });
  if (heard && heard->running) return {};
  if (interrupt.raised()) return tl::unexpected(std::string());
  return tl::unexpected(state_->port + ": " + (heard ? heard->closed : "it does not open"));
}

std::optional<CommandResult> DirectBus::run(fieldcast::Command command,
                                            const Interrupt& interrupt) {
  command.requester = "command line";
  command.request_id = ++state_->commands;
  state_->results.forget_result();
  if (!state_->runner.post(std::move(command))) return std::nullopt;
  const auto answered = [](const Results::Heard& heard) { return heard.result.has_value(); };
  const auto heard =
      state_->results.wait(interrupt, kResultLimit, answered, [this] { state_->write_capture(); });
  return heard ? heard->result : std::nullopt;
}

}  // namespace fieldcast::cli
