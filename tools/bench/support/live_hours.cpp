#include "tools/bench/support/live_hours.hpp"

#include <malloc.h>

#include <cmath>
#include <cstdio>
#include <memory>
#include <random>
#include <string>
#include <vector>

#include "tools/bench/support/figures.hpp"
#include "tools/station/live/domain_inbox.hpp"
#include "tools/station/live/live_hub.hpp"

namespace fieldcast::bench {
namespace {

using namespace fieldcast::web;

constexpr int kChannels = 1000;  // each once a second
constexpr int kDevices = 50;
constexpr std::size_t kClients = 8;
constexpr Duration kStep = std::chrono::milliseconds{20};
constexpr int kStepsOfSecond = 50;

// Accepts frames after some steps: a fast client or a slow one.
struct Peer : LivePeer {
  void send_text(std::string text) override { bytes += text.size(); }
  void send_binary(std::shared_ptr<const std::string> frame) override {
    bytes += frame->size();
    under_way = true;
  }
  void wake_at(Instant when) override { wake = when; }
  void close(std::string_view) override { closed = true; }

  bool under_way = false, closed = false;
  Instant wake = kNever;
  std::uint64_t bytes = 0;
};

struct NoCommands : CommandSink {
  Submitted submit(const Caller&, StationCommand, Done done) override {
    done({.request_id = ++last, .user = "anna", .state = "done", .values = {1.0}});
    return last;
  }
  Submitted submit(const Caller&, AlarmAction, Done) override { return ++last; }
  std::optional<CommandOutcome> find(std::string_view, std::uint64_t) const override { return {}; }
  std::uint64_t last = 0;
};

struct Page {
  Peer peer;
  std::unique_ptr<LiveProtocol> protocol;
};

class Hours {
 public:
  void run(double hours) {
    announce();
    double first = 0;
    const int whole = static_cast<int>(std::ceil(hours));
    for (int hour = 1; hour <= whole; ++hour) {
      for (int second = 0; second < 3600; ++second) run_second(second);
      const double heap = static_cast<double>(::mallinfo2().uordblks) / 1e6;
      if (hour == 1) first = heap;
      std::printf("hour %d: heap %.3f MB, %llu frames encoded, %llu samples\n", hour, heap,
                  static_cast<unsigned long long>(frames_.counters().encoded),
                  static_cast<unsigned long long>(model_.counters().samples));
      std::fflush(stdout);
      if (hour == whole) print_figure("heap since the first hour", heap - first, "MB", "goal 0");
    }
  }

 private:
  static StationChannel channel(int number) {
    StationChannel made;
    made.bridge = "line-7";
    made.bus = "bus-" + std::to_string(number % 10);
    made.device = "unit-" + std::to_string(number % kDevices);
    made.channel = "channel-" + std::to_string(number);
    made.type = number % 20 == 0 ? "string(16)" : "float32";
    made.refresh = std::chrono::seconds{1};
    return made;
  }
  void announce() {
    for (int i = 0; i < kChannels; ++i) inbox_.on_channel(channels_.emplace_back(channel(i)));
  }

  void run_second(int second) {
    if (second % 60 == 0) visit();
    if (second % 600 == 300) restart_bridge();
    report(second);
    (void)model_.expire(now_);
    for (int step = 0; step < kStepsOfSecond; ++step) {
      for (int i = step; i < kChannels; i += kStepsOfSecond) publish(i);
      inbox_.deliver(model_, now_);
      hub_.on_news(now_);
      for (std::size_t i = 0; i < pages_.size(); ++i) turn(*pages_[i], i, step);
      now_ += kStep;
      utc_ += kStep.count();
    }
  }
  void publish(int number) {
    const StationChannel& about = channels_[static_cast<std::size_t>(number)];
    StationSample sample;
    sample.bus = about.bus;
    sample.device = about.device;
    sample.channel = about.channel;
    if (number % 20 == 0) {
      sample.value = "text of " + std::to_string(random_() % 1000) + " and more";
    } else {
      sample.value = static_cast<double>(random_() % 1000);
    }
    sample.quality = random_() % 1000 == 0 ? Quality::kBadNoResponse : Quality::kGood;
    sample.acquired_at = {utc_};
    sample.sequence = ++sequence_;
    inbox_.on_sample(sample);
  }
  // Pages connect, stay for a minute and disconnect; one of them reads almost nothing.
  void visit() {
    if (pages_.size() == kClients) pages_.erase(pages_.begin());
    auto page = std::make_unique<Page>();
    page->protocol = hub_.make({"anna", Role::kOperator, "10.0.0.7"}, page->peer);
    page->protocol->on_open(now_);
    page->protocol->on_text(R"({"subscribe":"*"})", now_);
    page->protocol->on_text(R"({"subscribe":"bus-1/unit-1/channel-1","refresh_ms":500})", now_);
    page->protocol->on_text(R"({"write":{"channel":"bus-1/unit-1/channel-1","value":2},"id":1})",
                            now_);
    pages_.push_back(std::move(page));
  }
  void turn(Page& page, std::size_t number, int step) {
    const bool takes = number % 4 != 3 || step == 0;
    if (page.peer.under_way && takes) {
      page.peer.under_way = false;
      page.protocol->on_taken(now_);
    }
    if (page.peer.wake <= now_) {
      page.peer.wake = kNever;
      page.protocol->on_wake(now_);
    }
  }
  void restart_bridge() {
    for (int i = 0; i < kChannels; ++i) {
      const StationChannel& about = channels_[static_cast<std::size_t>(i)];
      inbox_.on_gone(about.bus, about.device, about.channel);
    }
    inbox_.deliver(model_, now_);
    for (const StationChannel& about : channels_) inbox_.on_channel(about);
  }
  void report(int second) {
    for (int i = 0; i < 10; ++i) {
      StationBusStatus bus;
      bus.bridge = "line-7";
      bus.bus = "bus-" + std::to_string(i);
      bus.reported_at = {utc_};
      inbox_.put(bus);
    }
    for (int i = 0; i < kDevices; ++i) {
      StationDeviceStatus device;
      device.bus = "bus-" + std::to_string(i % 10);
      device.device = "unit-" + std::to_string(i);
      device.reported_at = {utc_};
      inbox_.put(device);
    }
    StationAlarm alarm;
    alarm.bus = "bus-1";
    alarm.device = "unit-1";
    alarm.channel = "channel-" + std::to_string(second % 100);
    alarm.state = second % 2 == 0 ? AlarmState::kActive : AlarmState::kClear;
    inbox_.put(live_alarm(alarm));
  }

  LiveModel model_{1};
  FrameCache frames_{model_};
  ClientInterests interests_{[](const std::string&, Duration) {}};
  NoCommands commands_;
  LiveContext context_{model_, frames_, interests_, commands_, [] { return UtcTime{}; }, "bench"};
  LiveHub hub_{context_};
  DomainInbox inbox_{[] {}};
  std::vector<StationChannel> channels_;
  std::vector<std::unique_ptr<Page>> pages_;
  std::mt19937 random_{7};
  Instant now_{std::chrono::hours{1}};
  std::int64_t utc_ = 1'763'833'200'000'000'000;
  std::uint64_t sequence_ = 0;
};

}  // namespace

void run_hours(double hours) { Hours().run(hours); }

}  // namespace fieldcast::bench
