// The shell of one bus engine: its port, its timer, its leases and its reports. Everything runs on
// the io thread of the bus; BusRunner posts to it.
#pragma once

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <boost/asio/io_context.hpp>
#include <boost/asio/post.hpp>
#include <boost/asio/steady_timer.hpp>
#include <random>
#include <string>
#include <utility>

#include "bridge/base/back_off.hpp"
#include "bridge/base/check.hpp"
#include "bridge/base/clock.hpp"
#include "bridge/bus/bus_runner.hpp"
#include "bridge/bus/iconv_codec.hpp"
#include "bridge/bus/port_wait.hpp"
#include "bridge/bus/runner_timing.hpp"
#include "bridge/bus/wire_record.hpp"
#include "bridge/log/notice_log.hpp"
#include "bridge/port/device_watch.hpp"
#include "bridge/port/port.hpp"
#include "bridge/standby/master_lease.hpp"
#include "core/bus/bus_engine.hpp"
#include "core/dispatch/plan_draft.hpp"
#include "core/model/command.hpp"

namespace fieldcast {

namespace asio = boost::asio;

// process() passes an event to the engine and executes the actions.
class BusRunner::Loop final : public PortListener, public std::enable_shared_from_this<Loop> {
 public:
  Loop(asio::io_context& io, asio::io_context& plans, const BusSpec& spec, BusSink& sink,
       DialInRegistry* modules, const MasterLease* lease)
      : lease_of_master_(lease),
        io_(io),
        plans_(plans),
        fenced_(fence_of(spec.port).is(Fence::kListen)),
        sink_(sink),
        engine_(spec, codec_),
        port_(make_port(io, spec.port, modules)),
        timer_(io, *this),
        reopening_(io),
        ticking_(io),
        settled_(io),
        notices_(spec.name),
        record_(spec.name),
        mapping_(read_clocks()) {
    std::random_device random;  // differs between the bridges on one wire
    engine_.set_fence_order(random() % WireFence::kRanks, random());
    engine_.number_requests_from(static_cast<std::uint16_t>(random()));
    if (const auto* serial = std::get_if<SerialPortSpec>(&spec_.port))
      watch_.emplace(io, serial->path, [this] { device_came(); });
  }

  Gate& gate() { return *gate_; }
  [[nodiscard]] const BusSpec& spec() const { return spec_; }
  std::atomic<std::size_t> waiting{0};
  std::atomic<Instant> last_turn{steady_now()};

  void start(const BusInheritance& inherited) {
    engine_.inherit(inherited, steady_now());
    next_tick_ = std::chrono::steady_clock::now();
    tick();
    open_port();
  }

  void stop() {
    if (stopped_) return;
    revoke("the bus stops");
    process(StopRequested{}, steady_now());
    stopped_ = true;
    port_quiet_times().left(name_of(spec_.port), engine_.responses_until(), steady_now());
    report(steady_now(), BusState::kStopped);
    timer_.cancel();
    reopening_.cancel();
    ticking_.cancel();
    if (watch_) watch_->stop();
    port_->retire();
  }

  // Delivers received bytes before the event: on a fenced wire they may come from another master.
  void event(const BusEvent& event) {
    const auto* arrived = std::get_if<CommandArrived>(&event);
    if (arrived && stopped_)
      return sink_.complete(shutdown_result(arrived->command, steady_now()), mapping_);
    if (fenced_ && open_ && !revoked_) port_->poll();
    process(event, steady_now());
  }

  void probe(DeviceProbe probe, Probed done) {
    if (probe_) return done({}, mapping_);
    probe_.emplace(std::move(probe), std::move(done));
    continue_probe();
  }

  void lease(const std::string& who, const Granted& granted, Revoked revoked) {
    if (revoked_)
      return granted(tl::make_unexpected(LeaseRefused{true, "the bus is leased already"}));
    if (stopped_ || !open_) return granted(tl::make_unexpected(not_open()));
    if (has_tls(spec_.port))
      return granted(tl::make_unexpected(LeaseRefused{
          false, fmt::format("the port of bus {} has TLS and cannot be leased", spec_.name)}));
    revoked_ = std::move(revoked);
    report_soon_ = true;
    const Instant now = steady_now();
    // The programming software must not receive a response to one of our requests.
    Instant settled = engine_.responses_until();
    if (engine_.exchanging()) settled = std::max(settled, now + engine_.longest_timeout());
    record_.remark("leased to " + who, mapping_.to_utc(now));
    process(LeaseBegan{who}, now);
    if (settled <= now) return grant(granted);
    settling_ = granted;
    settled_.expires_after(std::min(settled - now, kLongestSettling));
    settled_.async_wait([self = shared_from_this()](boost::system::error_code cancelled) {
      if (cancelled) return;
      if (const Granted asked = std::exchange(self->settling_, {})) self->grant(asked);
    });
  }

  void change_line(std::uint64_t lease, const telnet::LineChange& change,
                   const telnet::LineChangeDone& done) {
    if (lease != lease_ || !revoked_ || stopped_) return done({});
    port_->change_line(change, done);
  }

  void end_lease(std::uint64_t lease, std::optional<std::string> lost) {
    if (lease != lease_ || !std::exchange(revoked_, {}) || stopped_) return;
    if (lost) {
      port_->close();
      return on_closed(std::move(*lost), Cause::kPortClosed);
    }
    port_->end_lease();
    record_.remark("the lease is over", mapping_.to_utc(steady_now()));
    report_soon_ = true;
    process(LeaseEnded{}, steady_now());
  }

  void set_trace(bool on) { record_.set_trace(on); }
  void set_capture(std::shared_ptr<CaptureTap> tap) { record_.set_tap(std::move(tap)); }

  void on_alarm() { wait_.on_alarm(); }
  void on_timer() {
    port_->poll();
    const Instant now = steady_now();
    if (!stopped_ && timer_.take(now)) process(TimerFired{}, now);
  }
  [[nodiscard]] bool awaits_close(Instant now) const {
    return std::holds_alternative<SerialPortSpec>(spec_.port) && open_ && !revoked_ && !stopped_ &&
           (engine_.exchanging() || timer_.at() - now <= PortWait<Loop>::kClose);
  }

  void on_opened() override {
    const Instant now = steady_now();
    open_ = true;
    if (watch_) watch_->stop();
    back_off_.opened(now);
    notices_.port_opened();
    record_.remark("the port is open", mapping_.to_utc(now));
    report_soon_ = true;
    process(Opened{port_quiet_times().until(name_of(spec_.port))}, now);
    // The first report is immediate: the caller that started the bus waits for it.
    if (!std::exchange(was_open_, true) && report_soon_) report(now);
  }

  void on_received(ByteView bytes, Instant arrival) override {
    record_.received(bytes, mapping_.to_utc(arrival));
    process(Received{bytes}, arrival);
    if (engine_.frame_ended()) record_.frame_ended(mapping_.to_utc(arrival));
    port_->sleep_until(engine_.quiet_until());
  }

  void on_closed(std::string reason, Cause cause) override {
    reason = with_port_name(spec_.port, reason);
    const bool was_open = std::exchange(open_, false);
    revoke(reason);
    const Instant now = steady_now();
    notices_.port_closed(reason, now);
    record_.remark("the port is closed: " + reason, mapping_.to_utc(now));
    report_soon_ = true;
    process(Closed{std::move(reason), cause}, now);
    reopen_later(now, was_open);
  }

 private:
  static constexpr Duration kReportPeriod = std::chrono::seconds{1};
  // Of a line that is leased while a response may still arrive.
  static constexpr Duration kLongestSettling = std::chrono::seconds{5};
  // Limit from decision to send on a fenced wire: less than FenceTimes leaves between two masters.
  static constexpr Duration kLatestSend = std::chrono::milliseconds{20};
  // Minimum, also if the state changes more often.
  static constexpr Duration kLeastReportGap = std::chrono::milliseconds{100};

  static std::string with_port_name(const PortSpec& port, const std::string& reason) {
    if (std::holds_alternative<DialInPortSpec>(port)) return reason;  // the reason names the module
    return fmt::format("{}: {}", name_of(port), reason);
  }

  static PortQuietTime& port_quiet_times() {
    static PortQuietTime all;
    return all;
  }

  // A server with one client, or a locked port, becomes free without notice: it is tried more
  // often.
  static Duration longest_back_off(const BusSpec& spec) {
    const auto fence = fence_of(spec.port);
    const bool taken = fence.is(Fence::kOneClient) || fence.is(Fence::kLock);
    return taken ? Duration{std::chrono::seconds{1}} : BackOff::kLongest;
  }

  static CommandResult shutdown_result(const Command& command, Instant now) {
    return rejection(command, Cause::kShutdown, "the bridge stops or restarts this bus", now);
  }

  LeaseRefused not_open() const {
    return {false, fmt::format("the port of bus {} is not open", spec_.name)};
  }

  void grant(const Granted& granted) {
    FileDescriptor line = port_->lease();
    if (!line.valid()) {
      revoked_ = {};
      process(LeaseEnded{}, steady_now());
      return granted(tl::make_unexpected(not_open()));
    }
    const auto* serial = std::get_if<SerialPortSpec>(&spec_.port);
    granted(LeasedLine{++lease_, std::move(line),
                       has_line(spec_.port) ? line_of(spec_.port) : LineFormat{},
                       serial ? std::optional(serial->line) : std::nullopt,
                       std::holds_alternative<Rfc2217PortSpec>(spec_.port), record_.tap()});
  }

  void revoke(const std::string& reason) {
    settled_.cancel();
    if (const Granted asked = std::exchange(settling_, {})) {
      revoked_ = {};
      return asked(tl::make_unexpected(LeaseRefused{false, reason}));
    }
    if (const Revoked revoked = std::exchange(revoked_, {})) revoked(reason);
  }

  void process(const BusEvent& event, Instant now) {
    if (stopped_) return;
    FIELDCAST_CHECK(!processing_);  // ports and sinks must not call back
    processing_ = true;
    actions_.clear();
    engine_.set_trace(record_.wanted());
    engine_.on_event(event, now, actions_);
    // The wire does not wait until samples are published.
    std::ranges::stable_partition(actions_, [](const Action& action) {
      return std::holds_alternative<Send>(action) || std::holds_alternative<Traced>(action);
    });
    for (Action& action : actions_) {
      std::visit([&](auto& what) { execute(what, now); }, action);
    }
    processing_ = false;
    for (const Bytes& bytes : std::exchange(not_sent_, {})) process(NotSent{bytes}, steady_now());
    if (report_soon_ && now - reported_ >= kLeastReportGap) report(now);
    wait_.next(now);
  }

  // On a fenced wire a late request may collide with another master. A request without the master's
  // lease is decided again later, when the master is known.
  [[nodiscard]] bool may_send(Instant decided) const {
    const bool too_late = fenced_ && steady_now() - decided > kLatestSend;
    return !too_late && (lease_of_master_ == nullptr || lease_of_master_->holds());
  }

  void execute(const Send& send, Instant now) {
    if (!may_send(now)) return not_sent_.push_back(send.bytes);
    record_.sent(send.bytes, engine_, mapping_.to_utc(now));
    send.others_wait ? port_->write_more(send.bytes) : port_->write(send.bytes);
    if (send.response_baud != 0) port_->receive_at(send.response_baud, send.bytes.size());
    port_->sleep_until(engine_.quiet_until());
  }
  void execute(const SetTimer& timer, Instant) { timer_.set(timer.at); }
  void execute(Publish& publish, Instant) { sink_.publish(std::move(publish.samples), mapping_); }
  void execute(const Promise& promise, Instant) { sink_.promise(promise.channel, promise.gap); }
  void execute(const Complete& complete, Instant) {
    if (!complete.result.ad_hoc) return sink_.complete(complete.result, mapping_);
    probe_->first.on_result(complete.result);
    gate_->post([self = shared_from_this()] { self->continue_probe(); });
  }
  void execute(const Reopen& reopen, Instant now) {
    notices_.port_closed(reopen.reason, now);
    port_->close();
    reopen_later(now, std::exchange(open_, false));
  }
  void execute(const Notice& notice, Instant now) {
    notices_.notice(notice, now);
    report_soon_ = true;
  }
  void execute(const Traced& traced, Instant now) { record_.traced(traced, mapping_.to_utc(now)); }

  void execute(const MakePlan& wanted, Instant) {
    asio::post(plans_, [draft = wanted.draft, gate = gate_, self = weak_from_this()] {
      draft->make();
      gate->post([draft, self] {
        if (const auto loop = self.lock()) loop->event(PlanMade{draft});
      });
    });
  }

  void continue_probe() {
    const auto command = stopped_ ? std::nullopt : probe_->first.next();
    if (command) return event(CommandArrived{*command});
    const auto ended = *std::exchange(probe_, std::nullopt);
    ended.second(ended.first.devices(), mapping_);
  }

  void open_port() {
    if (watch_) tried_ = DeviceWatch::identity_of(std::get<SerialPortSpec>(spec_.port).path);
    port_->open(*this);
  }

  // The serial adapter was plugged in again.
  void device_came() {
    if (stopped_ || open_) return;
    back_off_.reset();
    reopening_.cancel();
    open_port();
  }

  // A connection that carried a response works, and perhaps one device closes it.
  void reopen_later(Instant now, bool was_open) {
    if (stopped_) return;
    if (was_open && engine_.responded_since_opened()) back_off_.reset();
    if (watch_) watch_->start(tried_);
    reopening_.expires_after(back_off_.closed(now));
    reopening_.async_wait([self = shared_from_this()](boost::system::error_code cancelled) {
      if (!cancelled && !self->stopped_) self->open_port();
    });
  }

  void tick() {
    const Instant now = steady_now();
    last_turn = now;
    mapping_ = mapping_.followed_by(read_clocks());
    notices_.tick(now);
    report(now);
    report_plan(now);
    next_tick_ += kReportPeriod;
    ticking_.expires_at(next_tick_);
    ticking_.async_wait([self = shared_from_this()](boost::system::error_code cancelled) {
      if (!cancelled && !self->stopped_) self->tick();
    });
  }

  void report(Instant now, std::optional<BusState> state = {}) {
    report_soon_ = false;
    reported_ = now;
    const UtcTime at = mapping_.to_utc(now);
    BusReport bus = engine_.bus_report(now);
    if (state) bus.state = *state;
    sink_.report(bus, at);
    for (std::size_t i = 0; i < spec_.devices.size(); ++i) {
      sink_.report(spec_.devices[i].name, engine_.device_report(static_cast<DeviceIndex>(i), now),
                   at);
    }
  }

  void report_plan(Instant now) {
    const std::uint64_t number = engine_.plan_number();
    if (number == plan_reported_ || (plan_reported_ != 0 && now < next_plan_report_)) return;
    plan_reported_ = number;
    next_plan_report_ = now + kPlanReportGap;
    sink_.report(engine_.plan_report(), mapping_.to_utc(now));
  }

  const MasterLease* const lease_of_master_;  // null: always held
  asio::io_context& io_;
  asio::io_context& plans_;
  const std::shared_ptr<Gate> gate_ = std::make_shared<Gate>(io_);
  const bool fenced_;  // other masters may be on the wire
  BusSink& sink_;
  IconvCodec codec_;
  BusEngine engine_;
  const BusSpec& spec_{engine_.spec()};
  std::unique_ptr<Port> port_;
  EngineTimer<Loop> timer_;
  PortWait<Loop> wait_{io_, *gate_, timer_, *port_, *this};
  asio::steady_timer reopening_;
  asio::steady_timer ticking_;
  asio::steady_timer settled_;
  std::chrono::steady_clock::time_point next_tick_;
  BackOff back_off_{longest_back_off(spec_)};
  std::optional<DeviceWatch> watch_;            // only for a serial port; active while it is closed
  std::optional<DeviceWatch::Identity> tried_;  // identity of the device at the last open
  NoticeLog notices_;
  WireRecord record_;
  UtcMapping mapping_;
  Actions actions_;
  std::uint64_t lease_ = 0;
  std::optional<std::pair<DeviceProbe, Probed>> probe_;  // the one that runs
  Granted settling_;  // a lease that waits until the line is silent
  Revoked revoked_;   // of the active lease; otherwise empty
  Instant reported_{};
  std::uint64_t plan_reported_ = 0;  // number of the plan; 0: none yet
  Instant next_plan_report_{};
  std::vector<Bytes> not_sent_;  // by the event that is processed
  bool open_ = false;
  bool report_soon_ = false;
  bool was_open_ = false;
  bool processing_ = false;
  bool stopped_ = false;
};

}  // namespace fieldcast
