// The thread that reads alarms and the reports of sites, and passes on the state of all of them.
#include <set>

#include "bridge/base/clock.hpp"
#include "tools/forward/outlet/nats/subject.hpp"
#include "tools/station/live/domain_inbox.hpp"
#include "tools/station/record/recorder.hpp"
#include "tools/station/stream/stream_shared.hpp"

namespace fieldcast::web {

namespace {

constexpr Duration kStatePeriod = std::chrono::seconds{1};  // of the state of the sites
constexpr std::int64_t kStateNextMs = 200;
constexpr int kMostAtOnce = 1000;  // entries or alarms of one turn

class StateReader {
 public:
  StateReader(StreamShared& shared, DomainInbox& inbox, Recorder* recorder,
              const std::function<void(const StationAlarmStatus&)>& on_alarm)
      : shared_(shared),
        inbox_(inbox),
        recorder_(recorder),
        on_alarm_(on_alarm),
        session_(shared.spec, "fieldcast-station " + shared.station + " state", true),
        reader_(shared, session_, true) {}

  void run() {
    pass_states(false);
    while (!shared_.is_ending()) {
      const bool ready = session_.is_ready(steady_now());
      if (ready) {
        subscribe();
        read_reports();
        read_alarms();
      }
      if (steady_now() >= next_) pass_states(ready);
      if (!ready || watcher_ == nullptr)
        (void)shared_.wait(std::chrono::milliseconds{kStateNextMs});
    }
  }

 private:
  void subscribe() {
    if (generation_ != session_.generation()) {
      watcher_.reset();
      alarms_.reset();
      generation_ = session_.generation();
      next_attempt_ = {};
    }
    if ((watcher_ && alarms_) || steady_now() < next_attempt_) return;
    next_attempt_ = steady_now() + kStatePeriod;
    std::string fault;
    if (!watcher_) {
      kvStore* const bucket = session_.bucket(shared_.spec.site_bucket);
      kvWatcher* made = nullptr;
      if (bucket == nullptr || kvStore_WatchAll(&made, bucket, nullptr) != NATS_OK)
        fault = "bucket " + shared_.spec.site_bucket + " cannot be read: it does not exist";
      watcher_.reset(made);
    }
    if (!alarms_) {
      auto made = subscribe_in_order(session_, shared_.spec.alarm_stream, "fieldcast-alarm.>",
                                     StartWith::kAll);
      if (made)
        alarms_ = *std::move(made);
      else if (fault.empty())
        fault = made.error();
    }
    shared_.set_fault(StreamPart::kState, fault);
  }

  void read_reports() {
    for (int i = 0; watcher_ && i < kMostAtOnce; ++i) {
      kvEntry* made = nullptr;
      const natsStatus status = kvWatcher_Next(&made, watcher_.get(), i == 0 ? kStateNextMs : 1);
      const forward::NatsEntry entry(made);
      if (status == NATS_TIMEOUT) return;
      if (status != NATS_OK) return watcher_.reset();
      // An entry without a value marks the end of the present ones.
      if (entry == nullptr || kvEntry_Operation(made) != kvOp_Put) continue;
      const auto report = site_report_from({static_cast<const char*>(kvEntry_Value(made)),
                                            static_cast<std::size_t>(kvEntry_ValueLen(made))});
      const std::string site = forward::name_of_token(kvEntry_Key(made));
      if (report && !site.empty()) shared_.sites.reported(site, *report, {kvEntry_Created(made)});
    }
  }

  void read_alarms() {
    for (int i = 0; alarms_ && i < kMostAtOnce; ++i) {
      natsMsg* received = nullptr;
      const natsStatus status = natsSubscription_NextMsg(&received, alarms_.get(), 1);
      const forward::NatsMessage message(received);
      if (status == NATS_TIMEOUT || status == NATS_SLOW_CONSUMER) return;
      if (status != NATS_OK) return alarms_.reset();
      const auto alarm = reader_.alarm_of(received);
      if (!alarm) continue;
      // The station refuses actions on alarms of the sites that it knows.
      const std::string& bus = alarm->alarm.bus;
      if (sites_of_alarms_.size() < SiteRegistry::kMaxSites &&
          sites_of_alarms_.insert(bus.substr(0, bus.find(':'))).second)
        pass_states(true);
      inbox_.put(live_alarm(*alarm));
      if (recorder_ != nullptr) recorder_->on_alarm_status(*alarm, read_clocks().utc);
      if (on_alarm_) on_alarm_(*alarm);
    }
  }

  void pass_states(bool ready) {
    next_ = steady_now() + kStatePeriod;
    SiteRegistry::News news = shared_.sites.news(read_clocks().utc);
    for (LiveSite& site : news.changed) inbox_.put(std::move(site));
    for (const std::string& site : news.silent) inbox_.on_silent(site);
    LiveStream stream{.commands = shared_.commands};
    stream.reason = ready ? shared_.fault() : session_.fault();
    stream.connected = ready && stream.reason.empty();
    if (reported_ == stream) return;
    reported_ = stream;
    inbox_.put(stream);
  }

  StreamShared& shared_;
  DomainInbox& inbox_;
  Recorder* const recorder_;
  const std::function<void(const StationAlarmStatus&)>& on_alarm_;
  NatsSession session_;
  MessageReader reader_;
  std::uint64_t generation_ = 0;
  forward::NatsWatcher watcher_;
  forward::NatsSubscription alarms_;
  Instant next_{}, next_attempt_{};
  std::optional<LiveStream> reported_;
  std::set<std::string> sites_of_alarms_;
};

}  // namespace

void run_state(StreamShared& shared, DomainInbox& inbox, Recorder* recorder,
               const std::function<void(const StationAlarmStatus&)>& on_alarm) {
  StateReader(shared, inbox, recorder, on_alarm).run();
}

}  // namespace fieldcast::web
