// A client of /live for tests: its peer, its commands and a virtual clock.
#pragma once

#include <cstring>
#include <string>
#include <vector>

#include "tests/tools/station/live/live_support.hpp"
#include "tools/station/live/frames.hpp"
#include "tools/station/live/live_hub.hpp"

namespace fieldcast::web {

class FakePeer : public LivePeer {
 public:
  void send_text(std::string message) override {
    if (closed.empty()) texts.push_back(std::move(message));
  }
  void send_binary(std::shared_ptr<const std::string> frame) override {
    if (under_way) std::abort();  // one frame at a time: contract of the interface
    under_way = true;
    frames.push_back(std::move(frame));
  }
  void wake_at(Instant when) override { wake = when; }
  void close(std::string_view reason) override { closed = reason; }

  std::vector<std::string> texts;
  std::vector<std::shared_ptr<const std::string>> frames;
  bool under_way = false;
  Instant wake = kNever;
  std::string closed;
};

class FakeCommands : public CommandSink {
 public:
  struct Asked {
    Caller caller;
    StationCommand command;
    std::function<void(const CommandOutcome&)> done;
  };
  Submitted submit(const Caller& caller, StationCommand command, Done done) override {
    if (full) return tl::unexpected(Refusal{"too many commands wait", "try again"});
    asked.push_back({caller, std::move(command), std::move(done)});
    return asked.size();
  }
  Submitted submit(const Caller&, AlarmAction, Done) override { return 0; }
  std::optional<CommandOutcome> find(std::string_view, std::uint64_t) const override {
    return std::nullopt;
  }
  std::vector<Asked> asked;
  bool full = false;
};

inline std::uint32_t channels_in(const std::string& frame) {
  std::uint32_t n = 0;
  std::memcpy(&n, frame.data() + 4, sizeof n);
  return n;
}

struct FakeDomain {
  void announce(const std::string& name, const std::string& type = "float32") {
    model.on_channel(channel_of(name, type));
  }
  void publish(const std::string& name, Value value) {
    model.on_sample(sample_of(name, std::move(value)));
    hub.on_news(now);
  }

  LiveModel model{100};
  FrameCache frames{model};
  std::vector<std::pair<std::string, Duration>> declared;
  ClientInterests interests{[this](const std::string& pattern, Duration refresh) {
    declared.emplace_back(pattern, refresh);
  }};
  FakeCommands commands;
  LiveContext context{model,  frames, interests, commands, [] { return UtcTime{7'000'000}; },
                      "1.2.3"};
  LiveHub hub{context};
  Instant now{std::chrono::seconds{10}};
};

// One client; the test decides when its socket accepts data.
struct LivePerson {
  LivePerson(FakeDomain& in, const std::string& user, Role role)
      : domain(in), client(in.hub.make({user, role, "10.0.0.7"}, peer)) {
    client->on_open(domain.now);
  }
  void say(std::string_view message) { client->on_text(message, domain.now); }
  // Simulates that the kernel accepted the last frame.
  void take() {
    peer.under_way = false;
    client->on_taken(domain.now);
  }
  // Advances the time; the peer wakes its client at the requested time.
  void wait(Duration time) {
    domain.now += time;
    if (peer.wake > domain.now) return;
    peer.wake = kNever;
    client->on_wake(domain.now);
  }
  // Accepts and waits until no more frame is sent.
  void settle() {
    do {
      if (peer.under_way) take();
      wait(LiveClient::kPeriod);
    } while (peer.under_way);
  }
  std::vector<std::string> texts() { return std::exchange(peer.texts, {}); }
  std::vector<std::shared_ptr<const std::string>> frames() {
    return std::exchange(peer.frames, {});
  }

  FakeDomain& domain;
  FakePeer peer;
  std::unique_ptr<LiveProtocol> client;
};

}  // namespace fieldcast::web
