#include "tools/cli/command/station/write_controller.hpp"

#include <fmt/format.h>

#include <utility>

namespace fieldcast::cli {
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
                fmt::format("no result within {}; whether it was executed is not known{}",
                            to_text(kResultLimit), held_remark(connection_, errand_->command.bus)));
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
