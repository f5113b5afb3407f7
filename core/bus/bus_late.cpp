// Answers that come late: what is owed, what may be asked meanwhile, and what a late answer is
// worth.
#include <algorithm>

#include "core/bus/bus_state.hpp"

namespace fieldcast {

// Answers of different devices are told apart by their address. Where there is none, everything on
// the bus is alike, whatever family it belongs to.
bool BusEngine::State::mistakable(const Asked& earlier, const Asked& later) const {
  const Protocol& first = *devices[earlier.device].protocol;
  const Protocol& second = *devices[later.device].protocol;
  const bool same_family = first.traits().name == second.traits().name;
  if (earlier.device != later.device) {
    const bool nameless = first.traits().identity == AnswerIdentity::kNone ||
                          second.traits().identity == AnswerIdentity::kNone;
    if (!nameless) return false;
    if (!same_family) return true;
  }
  return first.mistakable(earlier.request, earlier.context, later.request, later.context);
}

// A command must not take an answer from before it for its own, not even to the same read.
Instant BusEngine::State::askable_from(const Flight& next) const {
  if (owed.empty()) return kLongAgo;
  const auto sequence = static_cast<std::uint16_t>(devices[next.device].sequence + 1);
  return owed.askable_from({next.device, next.request, {sequence}, {}},
                           next.kind != Flight::Kind::kCommand);
}

// A read that is longer than its block by some items can be told apart from what is owed, and its
// answer ends all debts of the device: nothing need wait for their time.
bool BusEngine::State::make_distinct(Flight& read, Instant now) const {
  constexpr std::uint32_t kMostLonger = 4;  // times the alignment
  const DeviceRuntime& device = devices[read.device];
  auto& request = std::get<ReadRequest>(read.request);
  if (device.refused_longer || request.ranges.size() != 1) return false;
  if (!device.areas[request.ranges[0].area].blocks.gaps().empty()) return false;
  const Area& area = device.protocol->areas()[request.ranges[0].area];
  if (area.window) return false;
  const Range block = request.ranges[0];
  for (std::uint32_t times = 1; times <= kMostLonger; ++times) {
    if (device.spec->max_gap && times * area.alignment > *device.spec->max_gap) break;
    Range& longer = request.ranges[0];
    longer.count = block.count + times * area.alignment;
    if (longer.end() > area.items || !in_one_bank(area, longer.first, longer.end())) break;
    if (!device.protocol->size(read.request)) break;
    if (askable_from(read) > now) continue;
    read.longer = true;
    return true;
  }
  request.ranges[0] = block;
  return false;
}

Duration BusEngine::State::late_bound(const DeviceRuntime& device, const Request& request) const {
  const auto size = device.protocol->size(request);
  const Duration timeout = device.spec->timeout;
  const Duration bound =
      std::clamp(device.answer_time.longest() * 2, timeout * OwedAnswers::kLateFactor,
                 timeout * OwedAnswers::kMostFactor);
  return bound + line.characters(size ? size->answer_characters : 0);
}

// A flight has ended, or will be tried again: what its device owes now.
void BusEngine::State::settle_debts_of(const Flight& ended, bool answered, bool refused,
                                       Instant now) {
  (void)owed.expire(now);
  const DeviceRuntime& device = devices[ended.device];
  Asked asked{ended.device, ended.request, ended.context, driver.sent_until()};
  const Duration bound = late_bound(device, ended.request);
  if (answered) {
    last_answer = driver.answered();
    if (!refused) learn_head(ended);
    strays.clear();
    hear_anew();
    owed.answered(asked, refused, bound, now);
    return release_held(now);
  }
  strays.assign(unclaimed().begin(), unclaimed().end());
  const bool broken = broken_answer_came(ended);
  claimed = 0;
  if (broken) return strays.clear();
  OwedAnswers::Debt debt;
  debt.asked = std::move(asked);
  debt.bound = bound;
  debt.block = ended.block;
  const auto size = device.protocol->size(ended.request);
  debt.counts_until = driver.sent_until() + device.spec->timeout +
                      line.characters(size ? size->answer_characters : 0) + spec.gap_allowance;
  owed.owe(std::move(debt));
}

namespace {

DeviceRuntime::Head head_of(ByteView answer) {
  DeviceRuntime::Head head{};
  std::copy_n(answer.begin(), std::min(answer.size(), head.size()), head.begin());
  return head;
}

// Of the request, or its refusal.
bool is_answer(const Step& step) {
  return step.kind == Step::Kind::kDone ||
         (step.kind == Step::Kind::kFailed &&
          (step.cause == Cause::kDeviceError || step.cause == Cause::kDeviceBusy));
}

DeviceRuntime::Shape shape_of(const ReadRequest& read) {
  const Range& first = read.ranges.front();
  return {first.area, first.first, first.count, static_cast<std::uint32_t>(read.ranges.size())};
}

}  // namespace

void BusEngine::State::learn_head(const Flight& read) {
  constexpr std::size_t kMost = 1024;
  const auto* request = std::get_if<ReadRequest>(&read.request);
  if (request == nullptr) return;
  auto& heads = devices[read.device].heads;
  if (heads.size() >= kMost) heads.clear();
  heads[shape_of(*request)] = head_of(driver.received());
}

// The answer itself came, but noise had broken it: it is as long as the answer, and begins as the
// last one did. Then no other will come. In doubt one may: broken frames of others look alike.
bool BusEngine::State::broken_answer_came(const Flight& ended) const {
  const auto* request = std::get_if<ReadRequest>(&ended.request);
  const bool broken = driver.cause() == Cause::kChecksum || driver.cause() == Cause::kTruncated;
  if (request == nullptr || !broken || claimed > 0 || !driver.enough_came()) return false;
  const auto& heads = devices[ended.device].heads;
  const auto known = heads.find(shape_of(*request));
  return known != heads.end() && known->second == head_of(driver.received());
}

// An exchange is broken off from outside.
void BusEngine::State::owe_flight_under_way() {
  if (!driver.active() || !flight) return;
  OwedAnswers::Debt debt;
  debt.asked = {flight->device, flight->request, flight->context, driver.sent_until()};
  debt.bound = late_bound(devices[flight->device], flight->request);
  owed.owe(std::move(debt));
}

// The shortest beginning of `heard` in which the answer to this request shows.
std::size_t BusEngine::State::end_of_answer(const Asked& asked, ByteView heard) const {
  const Protocol& protocol = *devices[asked.device].protocol;
  Bytes out;
  for (std::size_t end = 1; end < heard.size(); ++end) {
    const auto exchange = protocol.begin(asked.request, asked.context);
    out.clear();
    (void)exchange->start(out);
    if (is_answer(exchange->on_bytes(heard.first(end), out))) return end;
  }
  return heard.size();
}

// Each debt has an exchange of its own, which knows the answer when it sees it. What begins right
// behind another answer is that one once more: no device speaks again without a pause. It settles
// nothing. Each character counts once: one answer never pays two debts.
std::size_t BusEngine::State::look_for_late_answers(ByteView heard, Instant now, Actions& actions) {
  const std::size_t whole = heard.size();
  Bytes out;
  for (std::size_t i = 0; i < owed.debts().size() && !heard.empty();) {
    OwedAnswers::Debt& owing = owed.debts()[i];
    const DeviceRuntime& device = devices[owing.asked.device];
    if (!owing.exchange) {
      owing.exchange = device.protocol->begin(owing.asked.request, owing.asked.context);
      out.clear();
      (void)owing.exchange->start(out);
    }
    const Step step = owing.exchange->on_bytes(heard, out);
    const bool mine =
        driver.active() && flight &&
        mistakable(owing.asked, {flight->device, flight->request, flight->context, {}});
    if (mine || !is_answer(step)) {
      ++i;
      continue;
    }
    heard = heard.subspan(end_of_answer(owing.asked, heard));
    const auto size = device.protocol->size(owing.asked.request);
    const Instant began = now - line.characters(size ? size->answer_characters : 0);
    const bool once_more = began < last_answer + line.characters(kBetweenAnswers);
    if (!once_more) {
      last_answer = now;
      late_answer_came(owed.take(i, now), step.kind == Step::Kind::kFailed, now, actions);
    }
    owed.nothing_heard();
    i = 0;  // those before it may be gone as well
  }
  release_held(now);
  return whole - heard.size();
}

void BusEngine::State::late_answer_came(OwedAnswers::Debt paid, bool refused, Instant now,
                                        Actions& actions) {
  DeviceRuntime& device = devices[paid.asked.device];
  const auto size = device.protocol->size(paid.asked.request);
  const Duration taken = std::max(paid.before, now - paid.asked.sent_until) -
                         line.characters(size ? size->answer_characters : 0);
  device.answer_time.late(taken);
  for (AreaLearning& area : device.areas) area.answer_time.late(taken);
  if (refused || paid.block.points.empty() || now > paid.counts_until) return;
  Flight late;
  late.device = paid.asked.device;
  late.request = paid.asked.request;
  late.block = paid.block;
  device_answered(late.device, actions);
  block_read(late, paid.exchange->reply(), now, now, actions);
  // Nor need it be asked again.
  if (flight && flight->waiting && flight->kind == Flight::Kind::kRead &&
      same_read(paid.asked, {flight->device, flight->request, {}, {}}))
    flight.reset();
}

// Nobody was asked: a late answer, one too many, or what others say. The line must fall silent
// before it is used.
void BusEngine::State::heard_stray(ByteView bytes, Instant now, Actions& actions) {
  driver.count_stray(bytes.size());
  if (bus_state != BusState::kRunning) return;
  if (strays_since == kNever) strays_since = now;
  if (now - strays_since < kLongestStray) free_at = std::max(free_at, now + silence);
  if (owed.empty()) return;
  if (strays.size() + bytes.size() > ExchangeDriver::kMaxReceived) {
    strays.clear();
    owed.nothing_heard();
  }
  append(strays, bytes);
  const std::size_t spoken_for = look_for_late_answers(strays, now, actions);
  strays.erase(strays.begin(), strays.begin() + static_cast<std::ptrdiff_t>(spoken_for));
}

// The exchange is done, but too soon: an answer that began before its request had ended.
bool BusEngine::State::is_another_answer() const {
  if (owed.owes_same({flight->device, flight->request, flight->context, {}})) return false;
  return devices[flight->device].answer_time.too_early(driver.answer_began(), line.characters(1));
}

void BusEngine::State::hold(const Block& block, Instant until, Instant now) {
  scheduler->failed(block, now, until);
  std::erase_if(held, [&](const Held& each) { return each.until <= now; });
  held.push_back({block, until});
}

// Debts have ended: what waited for that is due.
void BusEngine::State::release_held(Instant now) {
  (void)owed.expire(now);
  std::erase_if(held, [&](const Held& each) {
    if (each.until <= now) return true;
    Flight read;
    read.device = each.block.device;
    read.request = ReadRequest{each.block.ranges};
    if (askable_from(read) > now) return false;
    scheduler->failed(each.block, now, now);
    return true;
  });
}

}  // namespace fieldcast
