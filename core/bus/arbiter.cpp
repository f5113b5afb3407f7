#include "core/bus/arbiter.hpp"

#include <algorithm>

namespace fieldcast {

Arbiter::Arbiter(BusParts& parts)
    : commands_(parts.commands),
      reads_(parts.reads),
      devices_(parts.devices),
      late_(parts.late),
      wire_(parts.wire),
      command_gate_([this](const CommandJob& job) { return sendable_from(job); }) {}

std::optional<Bytes> Arbiter::next(Instant now) {
  rest_until_ = kLongAgo;
  if (now < wire_.free_at()) return std::nullopt;
  if (!wire_.waiting()) {
    auto flight = choose(now);
    if (!flight) return std::nullopt;
    command_was_last_ = flight->is_command();
    wire_.launch(std::move(*flight));
  }
  return send(now);
}

std::optional<Bytes> Arbiter::sign(Instant now, bool due) {
  if (wire_.waiting()) return std::nullopt;
  auto read = devices_.sign(now, late_.read_gate());
  if (!read || (!due && reads_.slack(now) < read->timeout)) return std::nullopt;
  Flight sign;
  sign.kind = Flight::Kind::kProbe;
  sign.asked = {read->device, std::move(read->request), {}, {}};
  wire_.launch(std::move(sign));
  return send(now);
}

std::optional<Flight> Arbiter::choose(Instant now) {
  if (!commands_.empty()) {
    const bool reads_first = command_was_last_ && !commands_.begun() && reads_.due(now);
    if (!reads_first) {
      if (auto command = choose_command(now)) return command;
      if (rest_until_ != kLongAgo) return std::nullopt;
    }
  }
  if (auto probe = choose_probe(now)) return probe;
  return choose_read(now);
}

std::optional<Flight> Arbiter::choose_command(Instant now) {
  const bool echo_unknown = wire_.driver().echo() == Echo::kUnknown;
  if (auto next = commands_.next(now, command_gate_, echo_unknown)) {
    Flight command;
    command.kind = Flight::Kind::kCommand;
    command.asked = {next->device, std::move(next->request), {}, {}};
    command.batch = next->batch;
    return command;
  }
  if (commands_.begun()) {
    const Instant from = commands_.sendable_from(command_gate_);
    if (from - now <= kLongestWait) rest_until_ = from;
  }
  return std::nullopt;
}

std::optional<Flight> Arbiter::choose_probe(Instant now) {
  auto due = devices_.probe(now, late_.read_gate(), [&] { return reads_.slack(now); });
  if (!due) return std::nullopt;
  Flight probe;
  probe.kind = Flight::Kind::kProbe;
  probe.asked = {due->device, std::move(due->request), {}, {}};
  probe.timeout = due->timeout;
  return probe;
}

std::optional<Flight> Arbiter::choose_read(Instant now) {
  const Instant next_admission = admit_deferred(now);
  auto decision = reads_.next(now, late_.read_gate());
  if (auto* next = std::get_if<ReadPath::Read>(&decision)) {
    Flight read;
    read.asked = {next->block.device, std::move(next->request), {}, {}};
    read.block = std::move(next->block);
    read.longer = next->longer;
    return read;
  }
  rest_until_ = std::min({std::get<Rest>(decision).until, devices_.next_probe(), next_admission,
                          commands_.sendable_from(command_gate_)});
  rest_until_ = std::max(rest_until_, now + kShortestRest);
  return std::nullopt;
}

Instant Arbiter::admit_deferred(Instant now) {
  std::vector<DeviceIndex> admitted;
  const Instant next = devices_.admit_deferred(
      now, [&] { return reads_.slack(now); }, admitted);
  for (const DeviceIndex device : admitted) suspend(device, now);
  return next;
}

Instant Arbiter::sendable_from(const CommandJob& job) const {
  const Instant from = devices_.paused_until(job.device());
  if (late_.none_owed()) return from;
  const auto request = job.next();
  if (!request) return from;
  return std::max(
      from, late_.sendable_from(job.device(), *request, LateResponseFilter::Purpose::kCommand));
}

Bytes Arbiter::send(Instant now) {
  const Flight& flight = wire_.flight();
  const DeviceIndex device = flight.asked.device;
  const Duration timeout =
      flight.timeout > Duration::zero()
          ? flight.timeout
          : devices_.timeout(device, flight.asked.request, flight.is_command());
  devices_.asked(device);
  late_.start_anew();
  return wire_.send({late_.next_context(device), timeout, devices_.rest_before(device, now)}, now);
}

void Arbiter::suspend(DeviceIndex device, Instant now) {
  if (const auto until = devices_.suspension(device, now)) reads_.suspend(device, *until);
}

}  // namespace fieldcast
