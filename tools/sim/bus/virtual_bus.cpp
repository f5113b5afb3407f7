#include "tools/sim/bus/virtual_bus.hpp"

#include <algorithm>
#include <stdexcept>
#include <utility>

namespace fieldcast::sim {
namespace {

constexpr Duration kReopenAfter = std::chrono::seconds{1};

std::unique_ptr<SimBus> plant_of(const BusSpec& spec, const BusFaults& faults, std::uint64_t seed) {
  auto plant = SimBus::make(spec, faults, seed, Instant{});
  if (!plant) throw std::runtime_error(plant.error());
  return std::move(*plant);
}

}  // namespace

VirtualBus::VirtualBus(const BusSpec& spec, const BusFaults& faults, std::uint64_t seed,
                       Watcher watcher)
    : spec_(spec),
      plant_(plant_of(spec_, faults, seed)),
      engine_(std::in_place, spec_),
      watcher_(std::move(watcher)),
      character_(line_of(spec.port).characters(1)) {
  plug();
}

void VirtualBus::run_until(Instant until) {
  for (;;) {
    const Instant line_due = line_ ? line_->next_due() : kNever;
    const Instant due = std::min({timer_, line_due, reopen_at_, delayed_until_});
    if (due > until) break;
    now_ = std::max(now_, due);
    if (line_due <= now_) {
      received_.clear();
      line_->advance(now_, received_);
      if (on_received && !received_.empty()) on_received(received_);
      if (engine_ && !received_.empty()) receive();
    }
    if (delayed_until_ <= now_) {
      delayed_until_ = kNever;
      if (engine_) feed(Received{std::exchange(delayed_, {})});
    }
    if (reopen_at_ <= now_) plug();
    if (timer_ <= now_) {
      timer_ = kNever;
      feed(TimerFired{});
    }
  }
  now_ = until;
}

void VirtualBus::delay_received(Duration longest, std::uint64_t seed) {
  longest_delay_ = longest;
  random_.seed(seed);
}

void VirtualBus::receive() {
  if (longest_delay_ == Duration::zero()) return feed(Received{received_});
  append(delayed_, received_);
  if (delayed_until_ != kNever) return;
  const auto range = static_cast<std::uint64_t>(longest_delay_.count()) + 1;
  delayed_until_ = now_ + Duration{static_cast<std::int64_t>(random_() % range)};
}

void VirtualBus::feed(const BusEvent& event) {
  Actions actions;
  if (!spare_.empty()) {
    actions = std::move(spare_.back());
    spare_.pop_back();
  }
  engine_->on_event(event, now_, actions);
  make_plans(*engine_, now_, actions);
  for (const Action& action : actions) act(action);
  actions.clear();
  spare_.push_back(std::move(actions));
}

void VirtualBus::unplug() {
  line_.reset();
  delayed_.clear();
  reopen_at_ = delayed_until_ = kNever;
  feed(Closed{"unplugged"});
}

void VirtualBus::plug() {
  reopen_at_ = kNever;
  line_ = plant_->open_line();
  feed(Opened{});
}

void VirtualBus::replace_engine(const BusSpec& spec, Duration absence, const Opened& opened) {
  engine_.reset();
  timer_ = reopen_at_ = kNever;
  run_until(now_ + absence);
  spec_ = spec;
  engine_.emplace(spec_);
  const bool connection = std::holds_alternative<TcpPortSpec>(spec_.port);
  if (!line_ || connection) line_ = plant_->open_line();
  feed(opened);
}

void VirtualBus::send(ByteView bytes, std::uint32_t response_baud) {
  wire_free_ = now_ + character_ * static_cast<std::int64_t>(bytes.size());
  if (line_) line_->receive(bytes, now_, response_baud);
  stamp(static_cast<std::uint64_t>(now_.time_since_epoch().count()));
  for (const std::uint8_t byte : bytes) stamp(byte);
}

void VirtualBus::act(const Action& action) {
  if (const auto* timer = std::get_if<SetTimer>(&action)) timer_ = std::max(timer->at, now_);
  if (const auto* publish = std::get_if<Publish>(&action)) {
    for (const Sample& sample : publish->samples) stamp(sample.sequence);
  }
  if (std::holds_alternative<Reopen>(action)) {
    line_.reset();
    delayed_.clear();
    delayed_until_ = kNever;
    reopen_at_ = now_ + kReopenAfter;
  }
  if (watcher_) watcher_(action);
  if (const auto* sent = std::get_if<Send>(&action)) send(sent->bytes, sent->response_baud);
}

}  // namespace fieldcast::sim
