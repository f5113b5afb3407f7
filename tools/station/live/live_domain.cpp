#include "tools/station/live/live_domain.hpp"

#include <malloc.h>

#include <boost/asio/post.hpp>
#include <utility>

#include "bridge/base/clock.hpp"

namespace fieldcast::web {
namespace {

constexpr std::chrono::seconds kLook{1};  // period of the check for overdue values
constexpr std::uint64_t kTrimmedAfter = 10'000;

class StationPort : public CommandPort {
 public:
  explicit StationPort(Sites& station) : station_(station) {}
  std::uint64_t reserve_request_id() override { return station_.reserve_request_id(); }
  tl::expected<std::uint64_t, StationFault> send(StationCommand command) override {
    return station_.send(std::move(command), CommandController::kFinding);
  }
  tl::expected<std::uint64_t, StationFault> send(AlarmAction action) override {
    return station_.send(std::move(action), CommandController::kFinding);
  }
  void declare(const std::string& pattern, Duration refresh) override {
    // a station with its own interest list may not declare more
    if (!station_.may_declare_interest()) return;
    refresh == Duration{} ? station_.withdraw_interest(pattern)
                          : station_.declare_interest(pattern, refresh);
  }

 private:
  Sites& station_;
};

// Milliseconds of the clock, so that versions increase over restarts of the program.
std::uint64_t first_version() {
  return static_cast<std::uint64_t>(read_clocks().utc.nanoseconds / 1'000'000);
}

}  // namespace

struct LiveDomain::State {
  State(boost::asio::io_context& context, const std::vector<DdsSite>& sites,
        const std::string& name, const std::string& version, Audit* audit, DomainTap also)
      : io(context),
        tap(std::move(also)),
        live{model, frames, interests, desk, [] { return read_clocks().utc; }, version},
        desk(context, port, audit,
             [this](const CommandOutcome& outcome) { hub.on_outcome(outcome); }),
        station(sites, name) {}

  void listen();
  void deliver();
  void watch();  // checks for overdue values
  void give_memory_back();
  template <class Message, class Tap>
  auto both(void (DomainInbox::*note)(const Message&), const Tap& also) {
    return [this, note, &also](const Message& message) {
      (inbox.*note)(message);
      if (also) also(message);
    };
  }
  template <class Message>
  auto to_inbox(void (DomainInbox::*note)(const Message&)) {
    return [this, note](const Message& message) { (inbox.*note)(message); };
  }

  boost::asio::io_context& io;
  const DomainTap tap;
  std::shared_ptr<bool> open = std::make_shared<bool>(true);  // posted tasks hold it weakly
  LiveModel model{first_version()};
  std::uint64_t trimmed_at = 0;  // number of forgotten channels at the last malloc_trim()
  FrameCache frames{model};
  ClientInterests interests{
      [this](const std::string& pattern, Duration refresh) { desk.declare(pattern, refresh); }};
  LiveContext live;
  LiveHub hub{live};
  boost::asio::steady_timer overdue{io};
  DomainInbox inbox{[this, weak = std::weak_ptr(open)] {
    boost::asio::post(io, [this, weak] {
      if (!weak.expired()) deliver();
    });
  }};
  StationPort port{station};
  CommandController desk;
  Sites station;  // last member: its callbacks use the members above
};

void LiveDomain::State::deliver() {
  const Instant now = steady_now();
  inbox.deliver(model, now);
  hub.on_news(now);
}

void LiveDomain::State::watch() {
  overdue.expires_after(kLook);
  overdue.async_wait([this, weak = std::weak_ptr(open)](boost::system::error_code cancelled) {
    if (cancelled || weak.expired()) return;
    deliver();  // deliver first, so that waiting values are not overdue
    const Instant now = steady_now();
    if (model.expire(now) > 0) hub.on_news(now);
    frames.expire(now);
    give_memory_back();
    watch();
  });
}

// By itself the C library returns only the top of the heap.
void LiveDomain::State::give_memory_back() {
  const std::uint64_t forgotten = model.counters().forgotten;
  if (forgotten - trimmed_at < kTrimmedAfter) return;
  trimmed_at = forgotten;
  ::malloc_trim(0);
}

void LiveDomain::State::listen() {
  station.on_result([this](const StationResult& result) { desk.on_result(result); });
  station.subscribe_bridges(to_inbox(&DomainInbox::on_bridge),
                            to_inbox(&DomainInbox::on_bridge_gone));
  station.subscribe_bus_status(to_inbox(&DomainInbox::on_bus_status),
                               to_inbox(&DomainInbox::on_bus_gone));
  station.subscribe_device_status(both(&DomainInbox::on_device_status, tap.device_status),
                                  to_inbox(&DomainInbox::on_device_gone));
  station.subscribe_read_plans(to_inbox(&DomainInbox::on_read_plan),
                               to_inbox(&DomainInbox::on_read_plan_gone));
  station.subscribe<ProgramSessionReport>(to_inbox(&DomainInbox::on_session));
  station.subscribe_alarms(both(&DomainInbox::on_alarm, tap.alarm),
                           to_inbox(&DomainInbox::on_alarm_gone));
  station.subscribe_alarm_status(both(&DomainInbox::on_alarm_status, tap.alarm_status),
                                 to_inbox(&DomainInbox::on_alarm_status_gone));
  station.subscribe_channels(
      both(&DomainInbox::on_channel, tap.channel),
      [this](const std::string& bus, const std::string& device, const std::string& channel) {
        inbox.on_gone(bus, device, channel);
        if (tap.gone) tap.gone(bus, device, channel);
      });
  station.subscribe_samples(both(&DomainInbox::on_sample, tap.sample));
}

LiveDomain::LiveDomain(boost::asio::io_context& io, const std::vector<DdsSite>& sites,
                       const std::string& name, const std::string& version, Audit* audit,
                       DomainTap tap)
    : state_(std::make_unique<State>(io, sites, name, version, audit, std::move(tap))) {
  state_->listen();
  state_->watch();
}

LiveDomain::~LiveDomain() {
  state_->open.reset();
  state_->overdue.cancel();
  state_->desk.close();
}

const LiveModel& LiveDomain::model() const { return state_->model; }
CommandController& LiveDomain::commands() { return state_->desk; }
LiveHub& LiveDomain::hub() { return state_->hub; }

MakeLiveProtocol LiveDomain::make_protocol() {
  return [this](const Caller& caller, LivePeer& peer) { return state_->hub.make(caller, peer); };
}

std::vector<std::string> LiveDomain::missing_servers() const {
  return state_->station.missing_servers();
}

LiveDomain::Counters LiveDomain::counters() const {
  const State& state = *state_;
  return {state.inbox.counters(), state.model.counters(),         state.frames.counters(),
          state.hub.counters(),   state.station.block_counters(), state.model.count(),
          state.hub.count(),      state.interests.count()};
}

}  // namespace fieldcast::web
