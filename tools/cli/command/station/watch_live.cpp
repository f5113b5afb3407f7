#include "tools/cli/command/station/watch_live.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <string>
#include <utility>
#include <variant>

#include "tools/cli/screen/watch_screen.hpp"
#include "tools/cli/terminal/interrupt.hpp"
#include "tools/cli/terminal/terminal.hpp"

namespace fieldcast::cli {

namespace {

constexpr Duration kDrawAgain = std::chrono::milliseconds{100};
constexpr Duration kSettled = std::chrono::seconds{1};  // wait after an interest became effective

Moment moment_now() { return {instant_now(), utc_now()}; }

class WatchLive {
 public:
  WatchLive(const WatchOptions& options, const Connection& connection, DomainView& domain,
            WatchModel& model)
      : options_(options),
        connection_(connection),
        domain_(domain),
        model_(model),
        screen_(model, status_, options.unicode),
        desk_(domain, connection),
        began_(instant_now()),
        last_news_(began_) {
    domain_.subscribe_status();
    domain_.subscribe_results();
  }

  void run(Instant end) {
    Terminal terminal;
    auto next_draw = began_;
    for (auto now = began_; now < end && !quit_ && !domain_.inbox().closed(); now = instant_now()) {
      bool pressed = false;
      // Processes all pending keys, then draws one frame.
      while (const auto key = terminal.key(pressed ? now : std::min(end, next_draw))) {
        pressed = true;
        take(screen_.on_key(*key, moment_now()));
        if (quit_ || domain_.inbox().closed()) return;
        now = instant_now();
      }
      for (const auto& event : domain_.inbox().take_present()) read(event, instant_now());
      now = instant_now();
      if (const auto outcome = desk_.step(now)) screen_.on_outcome(*outcome);
      if (!pressed && now < next_draw) continue;
      tell(now);
      terminal.draw(screen_.frame(moment_now(), terminal.size()));
      next_draw = now + kDrawAgain;
    }
  }

 private:
  void take(const Intent& intent) {
    if (std::holds_alternative<QuitIntent>(intent)) quit_ = true;
    if (const auto* write = std::get_if<WriteIntent>(&intent)) desk_.begin(*write, instant_now());
  }

  void read(const DomainEvent& event, Instant now) {
    if (const auto* sample = std::get_if<StationSample>(&event)) {
      if (model_.on_sample(*sample, now)) screen_.on_sample(*sample);
    } else if (const auto* channel = std::get_if<StationChannel>(&event)) {
      model_.on_channel(*channel);
      last_news_ = now;
    } else if (const auto* gone = std::get_if<ChannelGone>(&event)) {
      model_.on_gone(gone->path);
    } else if (const auto* result = std::get_if<StationResult>(&event)) {
      if (const auto outcome = desk_.on_result(*result)) screen_.on_outcome(*outcome);
    } else {
      update(status_, event);
    }
  }

  void tell(Instant now) {
    model_.on_counters(domain_.station().block_counters());
    if (!model_.anything_announced()) {
      screen_.set_notice(
          now - began_ <= kBridgeWait
              ? fmt::format("waiting for a bridge in {} ..", domain_text(connection_))
              : no_bridge_text(connection_, domain_.missing_servers()));
    } else {
      screen_.set_notice("the bridges that are there have no channel that matches");
    }
    if (options_.refresh && !remarked_ && model_.anything_announced() &&
        now - std::max(began_, last_news_) >= kSettled) {
      remarked_ = true;
      interest_remark_ = model_.interest_remark(*options_.refresh).value_or("");
    }
    screen_.set_remark(model_.lag_remark().value_or(interest_remark_));
  }

  const WatchOptions& options_;
  const Connection& connection_;
  DomainView& domain_;
  WatchModel& model_;
  StatusModel status_;
  WatchScreen screen_;
  WriteController desk_;
  const Instant began_;
  Instant last_news_;  // last growth of the catalogue
  bool remarked_ = false;
  std::string interest_remark_;
  bool quit_ = false;
};

}  // namespace

void watch_live(const WatchOptions& options, const Connection& connection, DomainView& domain,
                WatchModel& model, Instant end) {
  WatchLive(options, connection, domain, model).run(end);
}

namespace {

// Wait for a bridge in each turn of the screen's loop.
constexpr Duration kSendWait = std::chrono::milliseconds{10};
constexpr Duration kLifespan = std::chrono::seconds{5};
constexpr Duration kResultLimit = kLifespan + std::chrono::seconds{2};

}  // namespace

void WriteController::begin(const WriteIntent& intent, Instant now) {
  errand_ = channel_write(intent.path, intent.value, {intent.type, intent.unit, intent.verify});
  errand_->command.lifespan = kLifespan;
  sent_ = false;
  until_ = now + kBridgeWait;
}

std::optional<Outcome> WriteController::step(Instant now) {
  if (!errand_) return std::nullopt;
  if (sent_) {
    if (now < until_) return std::nullopt;
    return fail(Outcome::State::kNoResult,
                no_result_text(connection_, errand_->command.bus, kResultLimit));
  }
  const auto sent = domain_.station().send(errand_->command, kSendWait);
  if (sent) {
    errand_->outcome.result.request_id = *sent;
    sent_ = true;
    until_ = now + kResultLimit;
    return std::nullopt;
  }
  if (sent.error() != StationFault::kNoBridge)
    return fail(Outcome::State::kNotSent, std::string(to_text(sent.error())));
  if (now < until_) return std::nullopt;
  return fail(Outcome::State::kNoResult, not_served_text(connection_, errand_->command.bus));
}

std::optional<Outcome> WriteController::on_result(const StationResult& result) {
  if (!errand_ || !sent_ || result.request_id != errand_->outcome.result.request_id)
    return std::nullopt;
  errand_->outcome.result = result;
  return finish();
}

std::optional<Outcome> WriteController::fail(Outcome::State state, std::string reason) {
  errand_->outcome.state = state;
  errand_->outcome.result.reason = std::move(reason);
  return finish();
}

Outcome WriteController::finish() { return std::exchange(errand_, std::nullopt)->outcome; }

}  // namespace fieldcast::cli
