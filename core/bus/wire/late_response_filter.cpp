#include "core/bus/wire/late_response_filter.hpp"

#include <algorithm>

namespace fieldcast {
namespace {

// Returns true if a late response to `earlier` could be matched to `later`. The address
// distinguishes devices; without one, all responses on the bus are alike, whatever their family.
bool mistakable(const BusSetup& setup, const Asked& earlier, const Asked& later) {
  const Protocol& first = setup.protocol(earlier.device);
  const Protocol& second = setup.protocol(later.device);
  const bool same_family = first.traits().name == second.traits().name;
  if (earlier.device != later.device) {
    const bool nameless = first.traits().identity == ResponseIdentity::kNone ||
                          second.traits().identity == ResponseIdentity::kNone;
    if (!nameless) return false;
    if (!same_family) return true;
  }
  return first.mistakable(earlier.request, earlier.context, later.request, later.context);
}

bool is_response(const Step& step) {
  return step.kind == Step::Kind::kDone ||
         (step.kind == Step::Kind::kFailed &&
          (step.cause == Cause::kDeviceError || step.cause == Cause::kDeviceBusy));
}

std::unique_ptr<Exchange> begin(const BusSetup& setup, const Asked& asked) {
  auto exchange = setup.protocol(asked.device).begin(asked.request, asked.context);
  Bytes out;
  (void)exchange->start(out);
  return exchange;
}

}  // namespace

LateResponseFilter::LateResponseFilter(const BusSetup& setup)
    : setup_(setup),
      owed_([&setup](const Asked& earlier, const Asked& later) {
        return mistakable(setup, earlier, later);
      }),
      devices_(setup.slots()),
      repetitions_(setup.line(), setup.spec().gap_allowance, setup.slots()) {}

Instant LateResponseFilter::sendable_from(DeviceIndex device, const Request& request,
                                          Purpose purpose) const {
  if (owed_.empty()) return kLongAgo;
  const auto sequence = static_cast<std::uint16_t>(devices_[device].sequence + 1);
  return owed_.askable_from({device, request, {sequence}, {}}, purpose == Purpose::kRead);
}

Duration LateResponseFilter::bound(const Asked& asked, Duration longest) const {
  const Duration timeout = setup_.device(asked.device).timeout;
  return std::clamp(longest * 2, timeout * PendingResponses::kLateFactor,
                    timeout * PendingResponses::kMostFactor) +
         setup_.response_wire_time(asked.device, asked.request);
}

void LateResponseFilter::responded(const Asked& asked, bool refused, Duration longest,
                                   const ExchangeDriver& driver, Instant now) {
  expire(now);
  last_response_ = driver.responded();
  repetitions_.responded(asked.device, driver.received(), driver.expected(), last_response_);
  if (!refused) learn_head(asked, driver.received());
  start_anew();
  owed_.responded(asked, refused, bound(asked, longest), now);
}

void LateResponseFilter::timed_out(Asked asked, Block block, Duration longest,
                                   const ExchangeDriver& driver, Instant now) {
  expire(now);
  const ByteView received = driver.received();
  const ByteView unclaimed = received.subspan(std::min(claimed_, received.size()));
  strays_.assign(unclaimed.begin(), unclaimed.end());
  const bool broken = broken_response_came(asked, driver);
  claimed_ = 0;
  if (broken) return strays_.clear();
  PendingResponses::Debt debt;
  debt.bound = bound(asked, longest);
  debt.block = std::move(block);
  debt.counts_until = asked.sent_until + setup_.device(asked.device).timeout +
                      setup_.response_wire_time(asked.device, asked.request) +
                      setup_.spec().gap_allowance;
  debt.asked = std::move(asked);
  owed_.owe(std::move(debt));
}

void LateResponseFilter::broken_off(Asked asked, Duration longest) {
  PendingResponses::Debt debt;
  debt.bound = bound(asked, longest);
  debt.asked = std::move(asked);
  owed_.owe(std::move(debt));
}

LateResponseFilter::Head LateResponseFilter::head_of(ByteView response) {
  Head head{};
  std::copy_n(response.begin(), std::min(response.size(), head.size()), head.begin());
  return head;
}

LateResponseFilter::Shape LateResponseFilter::shape_of(const ReadRequest& read) {
  const Range& first = read.ranges.front();
  return {first.area, first.first, first.count, static_cast<std::uint32_t>(read.ranges.size())};
}

void LateResponseFilter::learn_head(const Asked& read, ByteView response) {
  const auto* request = std::get_if<ReadRequest>(&read.request);
  if (request == nullptr) return;
  auto& heads = devices_[read.device].heads;
  if (heads.size() >= kMaxHeads) heads.clear();
  heads[shape_of(*request)] = head_of(response);
}

// Returns true if the response arrived but noise broke it: it has the expected length and the known
// beginning, so no other response will follow. In case of doubt returns false, since broken foreign
// frames look alike.
bool LateResponseFilter::broken_response_came(const Asked& asked,
                                              const ExchangeDriver& driver) const {
  const auto* request = std::get_if<ReadRequest>(&asked.request);
  const bool broken = driver.cause() == Cause::kChecksum || driver.cause() == Cause::kTruncated;
  if (request == nullptr || !broken || claimed_ > 0 || !driver.enough_came()) return false;
  const auto& heads = devices_[asked.device].heads;
  const auto known = heads.find(shape_of(*request));
  return known != heads.end() && known->second == head_of(driver.received());
}

// Bytes behind a frame that equals the last response show that this frame was a repetition of it:
// the response of this request is in the other bytes.
ExchangeDriver::Outcome LateResponseFilter::skip_repetition(Wire& wire, ByteView bytes, Instant now,
                                                            Bytes& out) {
  const ExchangeDriver& driver = wire.driver();
  if (driver.holds()) {
    wire.wait_on();
    repetitions_.discard();
    start_anew();
  }
  const auto outcome = wire.on_bytes(bytes, now, out);
  if (!driver.got_response(outcome) || !out.empty()) return outcome;
  const std::size_t size = repetitions_.find(driver.received(), driver.sent_from());
  if (size == 0 || size == driver.received().size()) return outcome;
  repetitions_.discard();
  start_anew();
  return wire.wait_on(size, now, out);
}

std::vector<LateResponseFilter::Late> LateResponseFilter::in_exchange(const Asked& under_way,
                                                                      const ExchangeDriver& driver,
                                                                      Instant now) {
  std::vector<Late> found;
  if (owed_.empty()) return found;
  const ByteView received = driver.received();
  claimed_ += find(received.subspan(std::min(claimed_, received.size())), &under_way, now, found);
  return found;
}

ExchangeDriver::Outcome LateResponseFilter::skip_late(Wire& wire, Instant now, Bytes& out) {
  const std::size_t size = claimed_;
  start_anew();
  return wire.wait_on(size, now, out);
}

std::vector<LateResponseFilter::Late> LateResponseFilter::in_strays(ByteView bytes, Instant now) {
  std::vector<Late> found;
  if (owed_.empty()) return found;
  if (strays_.size() + bytes.size() > ExchangeDriver::kMaxReceived) {
    strays_.clear();
    owed_.forget_bytes();
  }
  append(strays_, bytes);
  const std::size_t claimed = find(strays_, nullptr, now, found);
  strays_.erase(strays_.begin(), strays_.begin() + static_cast<std::ptrdiff_t>(claimed));
  return found;
}

// Each debt has its own exchange, which recognises the response. Bytes directly after a response
// are its repetition: no device sends again without a pause. Each character settles at most one
// debt. Returns the number of characters up to the end of the last late response.
std::size_t LateResponseFilter::find(ByteView bytes, const Asked* under_way, Instant now,
                                     std::vector<Late>& found) {
  const std::size_t whole = bytes.size();
  Bytes out;
  for (std::size_t i = 0; i < owed_.debts().size() && !bytes.empty();) {
    PendingResponses::Debt& owing = owed_.debts()[i];
    if (!owing.exchange) owing.exchange = begin(setup_, owing.asked);
    out.clear();
    const Step step = owing.exchange->on_bytes(bytes, out);
    const bool mine = under_way != nullptr && mistakable(setup_, owing.asked, *under_way);
    if (mine || !is_response(step)) {
      ++i;
      continue;
    }
    const ByteView frame = bytes.first(end_of_response(owing.asked, bytes));
    bytes = bytes.subspan(frame.size());
    const Instant began = now - setup_.response_wire_time(owing.asked.device, owing.asked.request);
    const bool once_more =
        began < last_response_ + setup_.line().characters(kBetweenResponses) ||
        (repetitions_.watches(owing.asked.device) && repetitions_.find(frame, began) > 0);
    if (!once_more) {
      last_response_ = now;
      repetitions_.responded(owing.asked.device, frame, 0, now);
      found.push_back(late_response(owed_.take(i, now), step.kind == Step::Kind::kFailed, now));
    }
    owed_.forget_bytes();
    i = 0;  // earlier debts may have been removed too
  }
  return whole - bytes.size();
}

std::size_t LateResponseFilter::end_of_response(const Asked& asked, ByteView bytes) const {
  for (std::size_t end = 1; end < bytes.size(); ++end) {
    Bytes out;
    if (is_response(begin(setup_, asked)->on_bytes(bytes.first(end), out))) return end;
  }
  return bytes.size();
}

LateResponseFilter::Late LateResponseFilter::late_response(PendingResponses::Debt paid,
                                                           bool refused, Instant now) const {
  Late late;
  late.refused = refused;
  late.taken = std::max(paid.before, now - paid.asked.sent_until) -
               setup_.response_wire_time(paid.asked.device, paid.asked.request);
  const bool counts = !refused && now <= paid.counts_until;
  if (counts && !paid.block.points.empty()) {
    late.block = std::move(paid.block);
    late.reply = paid.exchange->reply();
  }
  late.asked = std::move(paid.asked);
  return late;
}

void LateResponseFilter::start_anew() {
  claimed_ = 0;
  strays_.clear();
  owed_.forget_bytes();
}

}  // namespace fieldcast
