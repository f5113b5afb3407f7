#include "bridge/bus/bus_runner.hpp"

#include <atomic>
#include <utility>

#include "bridge/base/io_thread.hpp"
#include "bridge/bus/bus_loop.hpp"

namespace fieldcast {

BusRunner::BusRunner(IoThread& io, asio::io_context& plans, const BusSpec& spec, BusSink& sink,
                     DialInRegistry* modules, const MasterLease* lease)
    : context_(io.shared_context()),
      loop_(std::make_shared<Loop>(*context_, plans, spec, sink, modules, lease)) {}

const BusSpec& BusRunner::spec() const { return loop_->spec(); }

void BusRunner::start(BusInheritance inherited) {
  loop_->gate().post([loop = loop_, inherited = std::move(inherited)] { loop->start(inherited); });
}

bool BusRunner::post(Command command) {
  if (loop_->waiting.fetch_add(1, std::memory_order_relaxed) >= kMaxWaiting) {
    loop_->waiting.fetch_sub(1, std::memory_order_relaxed);
    return false;
  }
  return loop_->gate().post([loop = loop_, arrived = BusEvent{CommandArrived{std::move(command)}}] {
    loop->waiting.fetch_sub(1, std::memory_order_relaxed);
    loop->event(arrived);
  });
}

bool BusRunner::probe(DeviceProbe probe, Probed done) {
  return loop_->gate().post([loop = loop_, probe = std::move(probe), done = std::move(done)] {
    loop->probe(probe, done);
  });
}

void BusRunner::post(std::vector<InterestChanged> interests) {
  loop_->gate().post([loop = loop_, interests = std::move(interests)] {
    for (const InterestChanged& interest : interests) loop->event(interest);
  });
}

void BusRunner::post_inputs(std::function<std::vector<InputSample>()> fetch) {
  loop_->gate().post(
      [loop = loop_, fetch = std::move(fetch)] { loop->event(InputsArrived{fetch()}); });
}

void BusRunner::count_above(std::uint64_t number) {
  loop_->gate().post([loop = loop_, number] { loop->event(CountAbove{number}); });
}

void BusRunner::lease(std::string who, Granted granted, Revoked revoked) {
  loop_->gate().post([loop = loop_, who = std::move(who), granted = std::move(granted),
                      revoked = std::move(revoked)] { loop->lease(who, granted, revoked); });
}

void BusRunner::change_line(std::uint64_t lease, const telnet::LineChange& change,
                            telnet::LineChangeDone done) {
  loop_->gate().post([loop = loop_, lease, change, done = std::move(done)] {
    loop->change_line(lease, change, done);
  });
}

void BusRunner::end_lease(std::uint64_t lease, std::optional<std::string> lost) {
  loop_->gate().post([loop = loop_, lease, lost = std::move(lost)]() mutable {
    loop->end_lease(lease, std::move(lost));
  });
}

void BusRunner::set_trace(bool on) {
  loop_->gate().post([loop = loop_, on] { loop->set_trace(on); });
}

void BusRunner::set_capture(std::shared_ptr<CaptureTap> tap) {
  loop_->gate().post([loop = loop_, tap = std::move(tap)] { loop->set_capture(tap); });
}

Instant BusRunner::last_turn() const { return loop_->last_turn; }

std::future<void> BusRunner::stop() {
  auto done = std::make_shared<std::promise<void>>();
  auto ready = done->get_future();
  const bool posted = loop_->gate().post([loop = loop_, done] {
    loop->stop();
    // Cancelled handlers run after this one. When the next posted handler runs, none is left.
    loop->gate().post([loop, done] {
      loop->gate().close();
      done->set_value();
    });
  });
  if (!posted) done->set_value();
  return ready;
}

}  // namespace fieldcast
