#include "core/bus/exchange_flow.hpp"

#include <algorithm>

namespace fieldcast {

Arbiter::Arbiter(BusParts& parts)
    : parts_(parts),
      commands_(parts.commands),
      reads_(parts.reads),
      devices_(parts.devices),
      late_(parts.late),
      gateway_share_(parts.setup.spec().gateway ? parts.setup.spec().gateway->share : 0),
      command_gate_([this](const CommandJob& job) { return sendable_from(job); }) {}

std::optional<Bytes> Arbiter::next(Instant now) {
  rest_until_ = kLongAgo;
  deciding_ = now;
  fits_ = Duration::zero();
  fits_not_ = Duration::max();
  if (now < parts_.wire().free_at()) return std::nullopt;
  if (!parts_.wire().waiting()) {
    auto flight = choose(now);
    if (!flight) return std::nullopt;
    command_was_last_ = flight->is_command() && !flight->spare_time;
    parts_.wire().launch(std::move(*flight));
  }
  return send(now);
}

std::optional<Bytes> Arbiter::sign(Instant now, bool due) {
  if (parts_.wire().waiting()) return std::nullopt;
  auto read = devices_.sign(now, late_.read_gate());
  if (!read || (!due && reads_.slack(now) < read->timeout)) return std::nullopt;
  Flight sign;
  sign.kind = Flight::Kind::kProbe;
  sign.asked = {read->device, std::move(read->request), {}, {}};
  parts_.wire().launch(std::move(sign));
  return send(now);
}

std::optional<Flight> Arbiter::choose(Instant now) {
  if (!commands_.empty() && !parts_.command_in_flight()) {
    const bool reads_first = command_was_last_ && !commands_.keeps_wire() && reads_.due(now);
    if (!reads_first) {
      if (auto command = choose_command(now)) return command;
      if (rest_until_ != kLongAgo) return std::nullopt;
    }
  }
  if (auto probe = choose_probe(now)) return probe;
  return choose_read(now);
}

std::optional<Flight> Arbiter::choose_command(Instant now) {
  const bool echo_unknown = parts_.wire().driver().echo() == Echo::kUnknown;
  if (auto next = commands_.next(now, command_gate_, echo_unknown)) {
    Flight command;
    command.kind = Flight::Kind::kCommand;
    command.asked = {next->device, std::move(next->request), {}, {}};
    command.batch = next->batch;
    command.spare_time = commands_.first()->in_spare_time();
    if (commands_.first()->is_gateway_read() && gateway_share_ > 0)
      gateway_due_ = now + from_seconds(to_seconds(wire_use(next->device, command.asked.request)) /
                                        gateway_share_);
    return command;
  }
  if (commands_.keeps_wire()) {
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
    if (parts_.wires.size() > 1) reads_.launched(read.block, now);
    return read;
  }
  const Instant next_command =
      parts_.command_in_flight() ? kNever : commands_.sendable_from(command_gate_);
  rest_until_ = std::min(
      {std::get<Rest>(decision).until, devices_.next_probe(), next_admission, next_command});
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

Instant Arbiter::sendable_from(const CommandJob& job) {
  Instant from = devices_.paused_until(job.device());
  if (job.command().in_spare_time() && !job.started()) from = std::max(from, spare_from(job));
  if (late_.none_owed()) return from;
  const auto request = job.next();
  if (!request) return from;
  return std::max(
      from, late_.sendable_from(job.device(), *request, LateResponseFilter::Purpose::kCommand));
}

// With several requests in flight, the others use the rest of the connection meanwhile.
Duration Arbiter::wire_use(DeviceIndex device, const Request& request) const {
  return devices_.longest_exchange(device, request) / parts_.in_flight.now();
}

Instant Arbiter::spare_from(const CommandJob& job) {
  const Duration use = wire_use(job.device(), *job.next());
  if (use > fits_ && use < fits_not_)
    (reads_.has_headroom(deciding_, use) ? fits_ : fits_not_) = use;
  if (use <= fits_) return kLongAgo;
  return job.command().is_gateway_read() && gateway_share_ > 0 ? gateway_due_ : kNever;
}

Bytes Arbiter::send(Instant now) {
  const Flight& flight = parts_.wire().flight();
  const DeviceIndex device = flight.asked.device;
  // With several requests in flight, a long wait does not delay the others.
  const bool whole_timeout = flight.is_command() || parts_.wires.size() > 1;
  const Duration timeout = flight.timeout > Duration::zero()
                               ? flight.timeout
                               : devices_.timeout(device, flight.asked.request, whole_timeout);
  devices_.asked(device);
  late_.repetitions().asked();
  late_.start_anew();
  return parts_.wire().send(
      {late_.next_context(device), timeout, devices_.rest_before(device, now)}, now);
}

void Arbiter::suspend(DeviceIndex device, Instant now) {
  if (parts_.setup.is_ad_hoc(device)) return;
  if (const auto until = devices_.suspension(device, now)) reads_.suspend(device, *until);
}

OutcomeRouter::OutcomeRouter(BusParts& parts, Arbiter& arbiter)
    : parts_(parts),
      setup_(parts.setup),
      channels_(parts.channels),
      commands_(parts.commands),
      reads_(parts.reads),
      devices_(parts.devices),
      late_(parts.late),
      arbiter_(arbiter) {}

std::optional<Reopen> OutcomeRouter::conclude(bool done, Instant now, ActionSink& sink) {
  const Wire::Ended ended = parts_.wire().conclude(done, now);
  if (ended.without_response) {  // says nothing about the device
    deliver(parts_.wire().take(), ended, now, sink);
    return std::nullopt;
  }
  const DeviceIndex device = parts_.wire().flight().asked.device;
  // The device has responded to a request that was in flight with this one.
  const Duration waited = now - parts_.wire().flight().asked.sent_until;
  const bool dropped =
      !ended.responded && parts_.wires.size() > 1 && devices_.rest_before(device, now) < waited;
  if (ended.responded) parts_.in_flight.responded();
  if (dropped && !parts_.wire().flight().spare_time) parts_.in_flight.missed();
  note_try(ended, now, sink);
  parts_.wire().rest_until(late_.repetitions().rest_until());
  if (!done && may_repeat(ended.cause)) {
    devices_.repeated(device);
    parts_.wire().repeat();
    return std::nullopt;
  }
  const Flight flight = parts_.wire().take();
  if (done && !flight.no_response) learn(flight);
  const bool busy = ended.cause == Cause::kDeviceBusy;
  // A TCP stream that lost its framing is closed (Modbus Messaging on TCP/IP, 4.2.2 leaves the
  // reaction open). A serial line becomes silent instead, also behind a serial server, so a bad
  // frame only costs its exchange; and so does a whole frame of TCP with a wrong content.
  const bool numbered = setup_.protocol(device).traits().identity == ResponseIdentity::kSequence;
  const bool framing_lost = ended.cause == Cause::kMalformed && numbered && setup_.plain_tcp() &&
                            !parts_.wire().driver().ended_in_silence();
  if (ended.responded && !busy) devices_.responded(device, sink);
  deliver(flight, ended, now, sink);
  const bool lost = (!ended.responded || busy) && !dropped && !flight.spare_time &&
                    device_failed(device, ended, framing_lost, now, sink);
  arbiter_.suspend(device, now);
  if (framing_lost) {
    const auto codes = setup_.protocol(device).traits().codes;
    return Reopen{ended.device_code == 0 ? "the header of the response is not valid"
                                         : device_code_words(codes, ended.device_code)};
  }
  // All devices of this connection are silent: the connection itself may be dead.
  if (lost && !busy && devices_.all_offline() && over_network(setup_.spec().port))
    return Reopen{"no device responds"};
  return std::nullopt;
}

void OutcomeRouter::connection_lost(const Flight& flight, Cause cause, Instant now,
                                    ActionSink& sink) {
  if (flight.spare_time) return;  // see DeviceMonitor::gateway_read_ended()
  const DeviceIndex device = flight.asked.device;
  devices_.tried({.device = device, .cause = cause, .rest = flight.rest}, now, sink);
  device_failed(device, {.cause = cause, .spent = now - flight.started}, true, now, sink);
  arbiter_.suspend(device, now);
}

void OutcomeRouter::learn(const Flight& flight) {
  const DeviceIndex device = flight.asked.device;
  const Request& request = flight.asked.request;
  const Duration response_time = parts_.wire().driver().response_time();
  devices_.learn(device, request, response_time);
  if (std::holds_alternative<ReadRequest>(request) && !setup_.is_ad_hoc(device))
    reads_.learn(device, area_of(request), parts_.in_flight.planned(response_time));
  reads_.save_silence(parts_.wire().saved_silence());
}

void OutcomeRouter::note_try(const Wire::Ended& ended, Instant now, ActionSink& sink) {
  const Flight& flight = parts_.wire().flight();
  const ExchangeDriver& driver = parts_.wire().driver();
  const DeviceIndex device = flight.asked.device;
  const Duration longest = devices_.longest_response(device);
  if (ended.responded) {
    late_.responded(flight.asked, !ended.done, longest, driver, now);
    reads_.release_held(now, late_.read_gate());
  } else {
    late_.timed_out(flight.asked, flight.block, longest, driver, now);
  }
  if (flight.spare_time) {
    devices_.gateway_read_ended(device, ended.responded ? Cause::kNone : ended.cause, now);
    if (!ended.responded) return causes_.add(ended.cause);
  }
  devices_.tried({device, ended.cause, flight.rest, driver.responded(), driver.raw_received(),
                  driver.sent(), driver.echo_alone(), driver.expected()},
                 now, sink);
  if (ended.done) return;
  causes_.add(ended.cause);
  const auto codes = setup_.protocol(device).traits().codes;
  if (sink.tracing())
    sink.trace(device,
               std::string(to_text(ended.cause)) + device_code_note(codes, ended.device_code));
}

// Writes are never repeated blindly (CommandJob reads back), and probes repeat by themselves.
bool OutcomeRouter::may_repeat(Cause cause) const {
  if (cause == Cause::kDeviceError || cause == Cause::kDeviceBusy || cause == Cause::kUnsupported)
    return false;
  const Flight& flight = parts_.wire().flight();
  const DeviceIndex device = flight.asked.device;
  return flight.kind != Flight::Kind::kProbe && !flight.spare_time &&
         std::holds_alternative<ReadRequest>(flight.asked.request) &&
         flight.tries < setup_.device(device).retries &&
         (flight.is_command() || !devices_.sick(device));
}

void OutcomeRouter::deliver(const Flight& flight, const Wire::Ended& ended, Instant now,
                            ActionSink& sink) {
  const Instant acquired = parts_.wire().driver().responded();
  switch (flight.kind) {
    case Flight::Kind::kRead:
      if (ended.done) reads_.responded(flight.block, ended.exchange->reply(), acquired, now, sink);
      share(flight, ended, now, sink);
      if (ended.done) return;
      if (ended.cause == Cause::kDeviceBusy && devices_.stays_busy(flight.asked.device))
        devices_.busy(flight.asked.device, now);
      return reads_.failed(flight.block, flight.longer, ended.cause, ended.device_code, now, sink);
    case Flight::Kind::kCommand:
      share(flight, ended, now, sink);
      if (ended.done)
        return commands_.responded(flight.batch, ended.exchange->reply(), acquired, now, sink);
      return commands_.failed(flight.batch, ended.cause, ended.device_code, acquired, now, sink,
                              parts_.wire().driver().echo_alone() && !setup_.spec().echo
                                  ? "what was sent comes back, and nothing else"
                                  : "");
    case Flight::Kind::kProbe:
      if (ended.done) reads_.probe_responded(flight.asked.device);
      return;
  }
}

void OutcomeRouter::share(const Flight& flight, const Wire::Ended& ended, Instant now,
                          ActionSink& sink) {
  const DeviceIndex device = flight.asked.device;
  if (!setup_.spec().gateway || setup_.is_ad_hoc(device)) return;
  const auto* read = std::get_if<ReadRequest>(&flight.asked.request);
  if (read == nullptr) return commands_.written(device);
  if (!ended.done) return;
  const Reply& reply = ended.exchange->reply();
  for (std::size_t i = 0; i < std::min(read->ranges.size(), reply.size()); ++i) {
    if (reply[i].cause != Cause::kNone || !reply[i].absent.empty()) continue;
    commands_.read(
        device,
        {read->ranges[i], reply[i].items, flight.started, parts_.wire().driver().responded()}, now,
        sink);
  }
}

bool OutcomeRouter::device_failed(DeviceIndex device, const Wire::Ended& ended,
                                  bool connection_lost, Instant now, ActionSink& sink) {
  const bool lost = devices_.failed(device, ended.cause, now, sink, connection_lost);
  if (lost) {
    reads_.forget(device);
    for (ChannelIndex c = channels_.first_of(device); c < channels_.end_of(device); ++c)
      channels_.failing(c, ended.cause, now, ended.device_code);
  }
  devices_.defer_if_sick(device, ended.spent, now);
  return lost;
}

void OutcomeRouter::take_late(const std::vector<LateResponseFilter::Late>& responses, Instant now,
                              ActionSink& sink) {
  for (const LateResponseFilter::Late& response : responses) {
    const DeviceIndex device = response.asked.device;
    devices_.learn_late(device, response.taken);
    const bool awaited = !response.block.points.empty();
    // A response after the short timeout of a probe still shows that the device is back.
    const bool back = devices_.offline(device) && response.taken <= setup_.device(device).timeout;
    if (awaited || back) {
      devices_.responded(device, sink);
      arbiter_.suspend(device, now);  // resumes reading if the device was offline
    }
    if (!awaited) continue;
    reads_.responded(response.block, response.reply, now, now, sink);
    for (Wire& wire : parts_.wires) {
      const bool waits = wire.waiting() && wire.flight().kind == Flight::Kind::kRead;
      if (waits && same_read(response.asked, wire.flight().asked)) wire.drop();
    }
  }
  late_.expire(now);
  reads_.release_held(now, late_.read_gate());
}

void OutcomeRouter::take_unsolicited(const std::vector<UnsolicitedListener::Frame>& frames,
                                     Instant now, ActionSink& sink) {
  for (const UnsolicitedListener::Frame& frame : frames) {
    devices_.responded(frame.device, sink);
    arbiter_.suspend(frame.device, now);  // as in take_late()
    if (sink.tracing())
      sink.trace(frame.device, "unsolicited: " + setup_.text(frame.device, frame.range));
    std::vector<Sample> samples;
    channels_.unsolicited(frame.device, frame.range, frame.items, frame.absent, now, samples);
    sink.publish(std::move(samples));
  }
}

std::optional<Reopen> OutcomeRouter::silent(const std::vector<DeviceIndex>& devices, Instant now,
                                            ActionSink& sink) {
  bool lost = false;
  for (const DeviceIndex device : devices) {
    causes_.add(Cause::kNoResponse);
    lost = devices_.failed(device, Cause::kNoResponse, now, sink) || lost;
  }
  // As in conclude().
  if (lost && devices_.all_offline() && over_network(setup_.spec().port))
    return Reopen{"no device sends"};
  return std::nullopt;
}

}  // namespace fieldcast
