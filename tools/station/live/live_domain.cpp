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
  explicit StationPort(Station& station) : station_(station) {}
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
  Station& station_;
};

UtcTime utc_now() { return read_clocks().to_utc(steady_now()); }

// Milliseconds of the clock, so that versions increase over restarts of the program.
std::uint64_t first_version() {
  return static_cast<std::uint64_t>(read_clocks().utc.nanoseconds / 1'000'000);
}

}  // namespace

struct LiveDomain::State {
  State(boost::asio::io_context& context, const std::vector<DdsSite>& sites,
        const std::string& name, const std::string& version, Audit* audit, Recorder* records,
        std::function<void(const StationAlarmStatus&)> observer)
      : io(context),
        recorder(records),
        on_alarm(std::move(observer)),
        live{model, frames, interests, desk, [] { return read_clocks().utc; }, version},
        desk(context, port, audit,
             [this](const CommandOutcome& outcome) { hub.on_outcome(outcome); }),
        station(sites, name) {}

  void listen();
  void deliver();
  void watch();  // checks for overdue values
  void give_memory_back();

  boost::asio::io_context& io;
  Recorder* const recorder;  // called on DDS threads; may be null
  const std::function<void(const StationAlarmStatus&)> on_alarm;  // likewise
  std::shared_ptr<bool> open = std::make_shared<bool>(true);      // posted tasks hold it weakly
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
  Station station;  // its callbacks use the members above
  std::optional<BackFiller> back_filler;
  ConfigurationRequests configurations{io,
                                       [this](const std::string& bridge, std::string request) {
                                         return station.configuration(bridge, std::move(request),
                                                                      ConfigurationRequests::kWait);
                                       },
                                       [this] { station.cancel_configuration(); }};
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
  const auto put = [this](const auto& object) { inbox.put(object); };
  const auto remove = [this](const auto& last) { inbox.remove(last); };
  const auto put_alarm = [this](const auto& alarm) { inbox.put(live_alarm(alarm)); };
  const auto remove_alarm = [this](const auto& last) { inbox.remove(live_alarm(last)); };
  station.on_result([this](const StationResult& result) { desk.on_result(result); });
  station.subscribe_bridges(put, remove);
  station.subscribe_bus_status(put, remove);
  station.subscribe_read_plans(
      put, [this](const std::string& bus) { inbox.remove(StationReadPlan{.bus = bus}); });
  station.subscribe<StationDeviceDescription>(put, remove);
  station.subscribe_interests(put, remove);
  station.subscribe<ProgramSessionReport>(
      [this](const ProgramSessionReport& report) { inbox.put(LiveSession{report}); });
  station.subscribe<ProgramRequestReport>(
      [this](const ProgramRequestReport& report) { inbox.put(live_session(report)); });
  station.subscribe_alarms(put_alarm, remove_alarm);
  station.subscribe_device_status(
      [this](const StationDeviceStatus& status) {
        inbox.put(status);
        if (recorder != nullptr) recorder->on_device_status(status, utc_now());
      },
      remove);
  station.subscribe_alarm_status(
      [this](const StationAlarmStatus& status) {
        inbox.put(live_alarm(status));
        if (recorder != nullptr) recorder->on_alarm_status(status, utc_now());
        if (on_alarm) on_alarm(status);
      },
      remove_alarm);
  station.subscribe_channels(
      [this](const StationChannel& channel) {
        inbox.on_channel(channel);
        if (recorder != nullptr) recorder->on_channel(channel);
      },
      [this](const std::string& bus, const std::string& device, const std::string& channel) {
        inbox.on_gone(bus, device, channel);
        if (recorder != nullptr) recorder->on_gone(bus, device, channel);
      });
  station.subscribe_samples([this](const StationSample& sample) {
    inbox.on_sample(sample);
    if (recorder != nullptr) recorder->on_sample(sample, utc_now());
  });
}

LiveDomain::LiveDomain(boost::asio::io_context& io, const std::vector<DdsSite>& sites,
                       const std::string& name, const std::string& version, Audit* audit,
                       Recorder* recorder, const std::optional<BackfillSpec>& backfill,
                       std::function<void(const StationAlarmStatus&)> on_alarm)
    : state_(
          std::make_unique<State>(io, sites, name, version, audit, recorder, std::move(on_alarm))) {
  if (backfill) state_->back_filler.emplace(*backfill, state_->station, *recorder);
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
void LiveDomain::set_stream(CommandRoute& route) {
  state_->desk.set_stream(route, [&model = state_->model](const std::string& bus) {
    return model.objects().is_of_stream(bus);
  });
}
ConfigurationRequests& LiveDomain::configurations() { return state_->configurations; }

LiveHub& LiveDomain::hub() { return state_->hub; }
DomainInbox& LiveDomain::inbox() { return state_->inbox; }

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
