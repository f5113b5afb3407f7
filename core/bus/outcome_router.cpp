#include "core/bus/outcome_router.hpp"

namespace fieldcast {

OutcomeRouter::OutcomeRouter(BusParts& parts, Arbiter& arbiter)
    : setup_(parts.setup),
      channels_(parts.channels),
      commands_(parts.commands),
      reads_(parts.reads),
      devices_(parts.devices),
      late_(parts.late),
      wire_(parts.wire),
      arbiter_(arbiter) {}

std::optional<Reopen> OutcomeRouter::conclude(bool done, Instant now, ActionSink& sink) {
  const Wire::Ended ended = wire_.conclude(done, now);
  const DeviceIndex device = wire_.flight().asked.device;
  note_try(ended, now, sink);
  if (!done && may_repeat(ended.cause)) {
    devices_.repeated(device);
    wire_.repeat();
    return std::nullopt;
  }
  const Flight flight = wire_.take();
  if (done && !flight.unanswered) learn(flight);
  const bool busy = ended.cause == Cause::kDeviceBusy;
  if (ended.answered && !busy) devices_.answered(device, sink);
  deliver(flight, ended, now, sink);
  const bool lost = (!ended.answered || busy) && device_failed(device, ended, now, sink);
  arbiter_.suspend(device, now);
  // All devices of this connection are silent: the connection itself may be dead.
  if (lost && !busy && devices_.all_offline() && over_network(setup_.spec().port))
    return Reopen{"no device responds"};
  // A TCP stream that lost its framing is closed (Modbus Messaging on TCP/IP, 4.2.2 leaves the
  // reaction open). A serial line becomes silent instead, also behind a serial server, so a bad
  // frame only costs its exchange.
  const bool numbered = setup_.protocol(device).traits().identity == ResponseIdentity::kSequence;
  if (ended.cause == Cause::kMalformed && numbered && setup_.plain_tcp())
    return Reopen{"the header of the response is not valid"};
  return std::nullopt;
}

void OutcomeRouter::learn(const Flight& flight) {
  const DeviceIndex device = flight.asked.device;
  const Request& request = flight.asked.request;
  const Duration answer_time = wire_.driver().answer_time();
  devices_.learn(device, request, answer_time);
  if (std::holds_alternative<ReadRequest>(request))
    reads_.learn(device, area_of(request), answer_time);
}

void OutcomeRouter::note_try(const Wire::Ended& ended, Instant now, ActionSink& sink) {
  const Flight& flight = wire_.flight();
  const ExchangeDriver& driver = wire_.driver();
  const DeviceIndex device = flight.asked.device;
  const Duration longest = devices_.longest_answer(device);
  if (ended.answered) {
    late_.answered(flight.asked, !ended.done, longest, driver, now);
    reads_.release_held(now, late_.read_gate());
  } else {
    late_.unanswered(flight.asked, flight.block, longest, driver, now);
  }
  devices_.tried({device, ended.cause, flight.rest, driver.answered(), driver.raw_received(),
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
  const Flight& flight = wire_.flight();
  const DeviceIndex device = flight.asked.device;
  return flight.kind != Flight::Kind::kProbe &&
         std::holds_alternative<ReadRequest>(flight.asked.request) &&
         flight.tries < setup_.device(device).retries &&
         (flight.is_command() || !devices_.sick(device));
}

void OutcomeRouter::deliver(const Flight& flight, const Wire::Ended& ended, Instant now,
                            ActionSink& sink) {
  const Instant acquired = wire_.driver().answered();
  switch (flight.kind) {
    case Flight::Kind::kRead:
      if (ended.done)
        return reads_.answered(flight.block, ended.exchange->reply(), acquired, now, sink);
      if (ended.cause == Cause::kDeviceBusy && devices_.stays_busy(flight.asked.device))
        devices_.busy(flight.asked.device, now);
      return reads_.failed(flight.block, flight.longer, ended.cause, ended.device_code, now, sink);
    case Flight::Kind::kCommand:
      if (ended.done)
        return commands_.answered(flight.batch, ended.exchange->reply(), acquired, now, sink);
      return commands_.failed(flight.batch, ended.cause, ended.device_code, acquired, now, sink,
                              wire_.driver().echo_alone() && !setup_.spec().echo
                                  ? "what was sent comes back, and nothing else"
                                  : "");
    case Flight::Kind::kProbe:
      if (ended.done) reads_.probe_answered(flight.asked.device);
      return;
  }
}

bool OutcomeRouter::device_failed(DeviceIndex device, const Wire::Ended& ended, Instant now,
                                  ActionSink& sink) {
  const bool lost = devices_.failed(device, ended.cause, now, sink);
  if (lost) {
    reads_.forget(device);
    for (ChannelIndex c = channels_.first_of(device); c < channels_.end_of(device); ++c)
      channels_.failing(c, ended.cause, now, ended.device_code);
  }
  devices_.defer_if_sick(device, ended.spent, now);
  return lost;
}

void OutcomeRouter::take_late(const std::vector<LateResponseFilter::Late>& answers, Instant now,
                              ActionSink& sink) {
  for (const LateResponseFilter::Late& answer : answers) {
    const DeviceIndex device = answer.asked.device;
    devices_.learn_late(device, answer.taken);
    const bool awaited = !answer.block.points.empty();
    // A response after the short timeout of a probe still shows that the device is back.
    const bool back = devices_.offline(device) && answer.taken <= setup_.device(device).timeout;
    if (awaited || back) {
      devices_.answered(device, sink);
      arbiter_.suspend(device, now);  // resumes reading if the device was offline
    }
    if (!awaited) continue;
    reads_.answered(answer.block, answer.reply, now, now, sink);
    const bool waits = wire_.waiting() && wire_.flight().kind == Flight::Kind::kRead;
    if (waits && same_read(answer.asked, wire_.flight().asked)) wire_.drop();
  }
  late_.expire(now);
  reads_.release_held(now, late_.read_gate());
}

}  // namespace fieldcast
