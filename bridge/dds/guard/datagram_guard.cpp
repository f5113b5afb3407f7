#include "bridge/dds/guard/datagram_guard.hpp"

#include <algorithm>
#include <atomic>
#include <cstring>
#include <string>

#include "bridge/dds/guard/rtps_cursor.hpp"
#include "bridge/dds/library/library.hpp"

namespace fieldcast {

namespace {

constexpr std::size_t kPrefixAt = 8;  // offset in the header of a message
constexpr EntityBytes kEveryReader{};
constexpr std::size_t kMostWriters = 65'536, kMostAddresses = 1024, kMostFragmented = 1024;
constexpr std::size_t kBehind = 8;  // bytes that the library may read after the last fragment
constexpr std::size_t kSampleSizeAt = 32;              // offset in DATA_FRAG
constexpr Duration kGrace = std::chrono::seconds{10};  // beyond the lease of a participant
constexpr double kFragmentSeconds = 10;
// Rate at which the numbers of a writer may grow while it is not heard.
constexpr double kNumbersPerSecond = 100'000, kCreditSeconds = 60;
// Number of our own message that a participant has left: above those of its writer, and below the
// numbers that IncomingFilter uses (incoming_filter.cpp).
constexpr std::uint64_t kOurNumber = std::uint64_t{0x20000000} << 32;
constexpr std::uint8_t kFinal = 2;    // the flag of a HEARTBEAT or ACKNACK
constexpr std::size_t kFirstAt = 12;  // offset in HEARTBEAT, GAP and ACKNACK
// Pairs of a reader and a writer, of one participant and of all.
constexpr std::size_t kMostAcknowledged = 4096, kMostAcknowledgedInAll = 262'144;
constexpr std::size_t kMostOfOneParticipant = 16;  // addresses

void put(std::span<std::uint8_t> to, std::uint32_t value, bool little) {
  for (std::size_t i = 0; i < 4; ++i)
    to[i] = static_cast<std::uint8_t>(value >> 8 * (little ? i : 3 - i));
}
bool is_loopback(const DatagramGuard::Address& address) { return address[12] == 127; }
void put_number(std::span<std::uint8_t> to, std::int64_t number, bool little) {
  put(to, static_cast<std::uint32_t>(number >> 32), little);
  put(to.subspan(4), static_cast<std::uint32_t>(number), little);
}

}  // namespace

DatagramGuard::DatagramGuard(const RtpsLimits& limits) : limits_(limits) {
  fragment_bytes_.tokens = limits.fragment_bytes;
  counts_.tokens = static_cast<double>(kStep);
}

std::size_t DatagramGuard::Hash::operator()(const Seen& seen) const {
  std::uint64_t upper = 0, lower = 0;
  std::uint32_t reader = 0;
  std::memcpy(&upper, seen.writer.data(), 8);
  std::memcpy(&lower, seen.writer.data() + 8, 8);
  std::memcpy(&reader, seen.reader.data(), sizeof reader);
  return static_cast<std::size_t>((upper ^ (lower + reader) * 0x9e3779b97f4a7c15U) *
                                  0xff51afd7ed558ccdU);
}

DatagramGuard::Verdict DatagramGuard::check(std::span<const std::uint8_t> datagram,
                                            const Address& from, Instant now, Bytes& scratch) {
  datagram_ = datagram;
  from_ = from;
  now_ = now;
  scratch_ = &scratch;
  has_fragments_ = is_changed_ = false;
  before_.clear();
  if (const auto fault = fault_of(datagram, limits_, this)) return {fault, {}, std::move(before_)};
  // The library copies the last fragment by the size of the first one (CacheChange.h), so it may
  // read memory after the datagram: the buffer is extended.
  if (has_fragments_) {
    scratch.reserve(datagram.size() + limits_.sample_bytes + kBehind);
    copy();
    scratch.resize(datagram.size() + kBehind);
  }
  const std::span<const std::uint8_t> bytes = is_changed_ ? scratch : datagram;
  return {std::nullopt, bytes.first(datagram.size()), std::move(before_)};
}

std::span<std::uint8_t> DatagramGuard::copy() {
  if (!is_changed_) scratch_->assign(datagram_.begin(), datagram_.end());
  is_changed_ = true;
  return *scratch_;
}

ParticipantPrefix DatagramGuard::sender() const {
  ParticipantPrefix prefix{};
  std::copy_n(datagram_.begin() + kPrefixAt, prefix.size(), prefix.begin());
  return prefix;
}

// Returns false if a discovery event names a participant that sends from other addresses.
bool DatagramGuard::is_of_sender(const RtpsEvent& event) {
  if (limits_.relayed || (event.writer[3] & kBuiltIn) != kBuiltIn || is_loopback(from_))
    return true;
  const auto found = participants_.find(sender());
  if (found == participants_.end()) return true;
  Participant& of = found->second;
  if (std::ranges::count(of.addresses, from_) != 0) return true;
  // The participant has changed its address if it no longer sends from the earlier one.
  if (now_ - of.seen <= of.lease + kGrace) return false;
  of.addresses.assign(1, from_);
  return true;
}

std::optional<RtpsFault> DatagramGuard::on_event(const RtpsEvent& event) {
  // Of a member, signed: it is valid only as it is.
  if (event.is_protected && event.kind != Submessage::kDataFrag) return std::nullopt;
  // The library ignores it.
  if (event.to != ParticipantPrefix{} && own_ != ParticipantPrefix{} && event.to != own_)
    return std::nullopt;
  if (event.kind == Submessage::kAckNack) {
    on_acknowledgement(event);
    return std::nullopt;
  }
  if (!is_of_sender(event)) return RtpsFault::kSender;
  switch (event.kind) {
    case Submessage::kHeartbeat: return on_heartbeat(event);
    case Submessage::kGap: return on_gap(event);
    case Submessage::kDataFrag: return on_fragment(event);
    default: break;
  }
  // replaced by an empty parameter of the same length
  for (const std::size_t at : event.parameters.hidden) {
    const auto whole = copy();
    whole[event.parameters_at + at] = whole[event.parameters_at + at + 1] = 0;
  }
  return event.writer == kParticipantWriter ? on_participant(event) : on_endpoint(event);
}

std::optional<RtpsFault> DatagramGuard::on_participant(const RtpsEvent& event) {
  const ParameterFacts& facts = event.parameters;
  const auto& guid = facts.participant_guid.empty() ? facts.key_hash : facts.participant_guid;
  if (guid.empty()) return RtpsFault::kParameter;
  ParticipantPrefix prefix{};
  std::copy_n(guid.begin(), prefix.size(), prefix.begin());
  if (facts.status != 0) {
    // The library would store the number of an unknown participant, and later ignore its
    // announcements with lower numbers (StatelessReader.cpp).
    if (!limits_.relayed && !participants_.contains(prefix))
      copy()[event.at] = static_cast<std::uint8_t>(Submessage::kPad);
    forget(prefix);
    return std::nullopt;
  }
  if (const auto found = participants_.find(prefix); found != participants_.end()) {
    Participant& known = found->second;
    if (now_ - known.seen > known.lease) {  // the library has removed it, and counts from 0 again
      known.order = ++joined_;
      for (auto& endpoint : known.endpoints) endpoint.second = ++joined_;
    }
    known.seen = now_;
    known.lease = std::chrono::seconds{facts.lease_seconds};
    add_addresses(known, facts);
    return std::nullopt;
  }
  if (!may_join()) return RtpsFault::kJoinRate;
  if (participants_.size() >= limits_.participants && !make_room(false))
    return RtpsFault::kParticipants;
  Participant& joined = participants_[prefix];
  joined = {now_, std::chrono::seconds{facts.lease_seconds}, ++joined_, {}, {from_}, {}};
  add_addresses(joined, facts);
  return std::nullopt;
}

void DatagramGuard::add_addresses(Participant& of, const ParameterFacts& facts) {
  for (const auto& bytes : facts.addresses) {
    Address address{};
    std::ranges::copy(bytes, address.begin());
    if (of.addresses.size() < kMostOfOneParticipant && !std::ranges::count(of.addresses, address))
      of.addresses.push_back(address);
  }
}

// Takes one token of the sender's address for each new participant.
bool DatagramGuard::may_join() {
  if (joins_.size() >= kMostAddresses && !joins_.contains(from_)) joins_.clear();
  const double most = 4.0 * limits_.joins_per_second;
  auto [found, is_new] = joins_.try_emplace(from_, Bucket{most, now_});
  Bucket& bucket = found->second;
  bucket.tokens =
      std::min(most, bucket.tokens + to_seconds(now_ - bucket.filled) * limits_.joins_per_second);
  bucket.filled = now_;
  if (bucket.tokens < 1) return false;
  bucket.tokens -= 1;
  return true;
}

// Removes the participant that has been silent the longest beyond its lease. If there is none and a
// new participant needs the place, removes the oldest one that has announced no endpoint.
bool DatagramGuard::make_room(bool for_endpoints) {
  auto silent = participants_.end(), idle = participants_.end();
  for (auto one = participants_.begin(); one != participants_.end(); ++one) {
    const Participant& other = one->second;
    if (now_ - other.seen > other.lease + kGrace &&
        (silent == participants_.end() || other.seen < silent->second.seen))
      silent = one;
    if (!for_endpoints && other.endpoints.empty() &&
        (idle == participants_.end() || other.order < idle->second.order))
      idle = one;
  }
  const auto leaves = silent != participants_.end() ? silent : idle;
  if (leaves == participants_.end()) return false;
  before_ = participant_gone(leaves->first, kOurNumber + ++joined_);
  forget(ParticipantPrefix{leaves->first});
  return true;
}

void DatagramGuard::forget(const ParticipantPrefix& prefix) {
  const auto found = participants_.find(prefix);
  if (found == participants_.end()) return;
  endpoints_ -= found->second.endpoints.size();
  acknowledged_ -= found->second.acknowledged.size();
  participants_.erase(found);
}

std::optional<RtpsFault> DatagramGuard::on_endpoint(const RtpsEvent& event) {
  const ParameterFacts& facts = event.parameters;
  const auto& raw = facts.endpoint_guid.empty() ? facts.key_hash : facts.endpoint_guid;
  if (raw.empty()) return std::nullopt;  // the library ignores it
  Guid guid{};
  std::ranges::copy(raw, guid.begin());
  ParticipantPrefix prefix{};
  std::copy_n(guid.begin(), prefix.size(), prefix.begin());
  const auto found = participants_.find(prefix);
  // the library has no participant of that name
  if (found == participants_.end()) return std::nullopt;
  auto& endpoints = found->second.endpoints;
  if (facts.status != 0) {
    endpoints_ -= endpoints.erase(guid);
    return std::nullopt;
  }
  if (const auto known = endpoints.find(guid); known != endpoints.end()) {
    known->second = ++joined_;  // it may match other readers from now on
    return std::nullopt;
  }
  if (endpoints.size() >= limits_.endpoints) return RtpsFault::kEndpoints;
  if (endpoints_ >= limits_.endpoints_in_all) {
    found->second.seen = now_;  // it must not remove itself
    if (!make_room(true)) return RtpsFault::kEndpoints;
  }
  endpoints.emplace(guid, ++joined_);
  ++endpoints_;
  return std::nullopt;
}

DatagramGuard::Guid DatagramGuard::guid_of(const EntityBytes& writer) const {
  Guid guid{};
  std::copy_n(datagram_.begin() + kPrefixAt, 12, guid.begin());
  std::ranges::copy(writer, guid.begin() + 12);
  return guid;
}

// The order in which the writer was announced, built-in ones with their participant; 0: never.
std::uint64_t DatagramGuard::announced(const Guid& writer) const {
  ParticipantPrefix prefix{};
  std::copy_n(writer.begin(), prefix.size(), prefix.begin());
  const auto of = participants_.find(prefix);
  if (of == participants_.end()) return 0;
  if ((writer.back() & kBuiltIn) == kBuiltIn) return of->second.order;
  const auto found = of->second.endpoints.find(writer);
  return found == of->second.endpoints.end() ? 0 : found->second;
}

// The library may have counted no number of a writer that was announced again. It may also have
// kept the GAPs of it.
DatagramGuard::Writer& DatagramGuard::state_of(const Guid& writer, const EntityBytes& reader) {
  const Seen seen{writer, reader};
  if (writers_.size() >= kMostWriters && !writers_.contains(seen)) writers_.clear();
  Writer& state = writers_[seen];
  if (const std::uint64_t order = announced(writer); order != state.announced)
    state = {.announced = order, .gapped = state.gapped, .gap_end = state.gap_end};
  return state;
}

DatagramGuard::Writer& DatagramGuard::writer_of(const RtpsEvent& event) {
  const Guid guid = guid_of(event.writer);
  const std::int64_t counted = state_of(guid, kEveryReader).counted;
  Writer& writer = state_of(guid, event.reader);
  writer.counted = std::max(writer.counted, counted);
  if (writer.last < 0) return writer;
  // The numbers of a writer grow while it is not heard.
  const double silence = to_seconds(now_ - writer.seen);
  writer.credit += silence * kNumbersPerSecond;
  if (silence < kCreditSeconds) writer.credit = std::min<double>(writer.credit, kJump);
  writer.seen = now_;
  return writer;
}

// Returns false if the writer has no credit to reach this number.
bool DatagramGuard::may_reach(Writer& writer, std::int64_t number) const {
  if (writer.last < 0) {
    writer.seen = now_;
    writer.last = number;
    return true;
  }
  const auto further = static_cast<double>(number - writer.last);
  if (further <= 0) return true;
  if (further > writer.credit) return false;
  writer.credit -= further;
  writer.last = number;
  return true;
}

std::optional<RtpsFault> DatagramGuard::on_heartbeat(const RtpsEvent& event) {
  Writer& writer = writer_of(event);
  if (event.first > kFarthest || !may_reach(writer, event.base - 1))
    return RtpsFault::kSequenceNumber;
  writer.count = std::max(writer.count, event.count);
  if (event.first >= writer.gap_end) writer.gapped = 0;
  limit_count(event, writer, event.first);
  return std::nullopt;
}

// Bounds how far the library counts because of a HEARTBEAT with this first number. If that is too
// far, the HEARTBEAT announces the farthest number that is allowed, and no sample.
void DatagramGuard::limit_count(const RtpsEvent& event, Writer& writer, std::int64_t first) {
  counts_.tokens = std::min(static_cast<double>(kStep),
                            counts_.tokens + to_seconds(now_ - counts_.filled) * kCountsPerSecond);
  counts_.filled = now_;
  const std::int64_t further = first - 1 - writer.counted;
  if (further <= 0) return;
  const std::int64_t allowed = std::min(further, static_cast<std::int64_t>(counts_.tokens));
  counts_.tokens -= static_cast<double>(allowed);
  writer.counted += allowed;
  if (allowed == further) return;
  const auto part = copy().subspan(event.at);
  part[1] |= kFinal;
  put_number(part.subspan(kFirstAt), writer.counted + 1, event.little);
  put_number(part.subspan(kFirstAt + 8), writer.counted, event.little);
}

std::optional<RtpsFault> DatagramGuard::on_gap(const RtpsEvent& event) {
  Writer& writer = writer_of(event);
  if (!may_reach(writer, event.base - 1)) return RtpsFault::kGap;
  const std::int64_t range = event.base - event.first + 1;
  writer.gap_end = std::max(writer.gap_end, event.base);
  writer.gapped += range;
  if (writer.gapped <= kMostGapped) return std::nullopt;
  writer.gapped = 0;
  // Both have reader(4) writer(4), two numbers(8) and 4 more bytes.
  const auto part = copy().subspan(event.at);
  part[0] = static_cast<std::uint8_t>(Submessage::kHeartbeat);
  part[1] = static_cast<std::uint8_t>((event.little ? kLittleEndianFlag : 0) | kFinal);
  put_number(part.subspan(kFirstAt), event.base, event.little);
  put_number(part.subspan(kFirstAt + 8), writer.last, event.little);
  put(part.subspan(kFirstAt + 16), ++writer.count, event.little);
  limit_count(event, writer, event.base);
  return std::nullopt;
}

void DatagramGuard::on_acknowledgement(const RtpsEvent& event) {
  const auto of = participants_.find(sender());
  if (of == participants_.end()) return;  // the library ignores it
  auto& known = of->second.acknowledged;
  if (known.size() >= kMostAcknowledged || acknowledged_ >= kMostAcknowledgedInAll) {
    acknowledged_ -= known.size();
    known.clear();
  }
  const auto [found, is_new] =
      known.try_emplace({event.reader, event.writer}, Acknowledged{event.base, event.count});
  acknowledged_ += is_new ? 1 : 0;
  Acknowledged& last = found->second;
  if (is_new || event.count <= last.count) return;  // the library ignores repetitions
  const bool is_lower = event.base < last.base;
  last = {event.base, event.count};
  if (!is_lower) return;
  const auto part = copy().subspan(event.at);
  part[1] &= static_cast<std::uint8_t>(~kFinal);
  put_number(part.subspan(kFirstAt), 0, event.little);
  put(part.subspan(kFirstAt + 8), 0, event.little);  // no number is missing
  put(part.subspan(kFirstAt + 12), event.count, event.little);
}

// A new fragmented sample costs its size; the sum is restored within kFragmentSeconds.
std::optional<RtpsFault> DatagramGuard::on_fragment(const RtpsEvent& event) {
  has_fragments_ = true;
  if (event.buffer_size != event.sample_size)
    put(copy().subspan(event.at + kSampleSizeAt), event.buffer_size, event.little);
  const std::pair<Guid, std::int64_t> sample{guid_of(event.writer), event.first};
  if (std::ranges::count(fragmented_, sample) != 0) return std::nullopt;
  Bucket& bucket = fragment_bytes_;
  bucket.tokens = std::min<double>(
      limits_.fragment_bytes,
      bucket.tokens + to_seconds(now_ - bucket.filled) * limits_.fragment_bytes / kFragmentSeconds);
  bucket.filled = now_;
  if (bucket.tokens < event.sample_size) return RtpsFault::kFragmentMemory;
  bucket.tokens -= event.sample_size;
  fragmented_.push_back(sample);
  if (fragmented_.size() > kMostFragmented) fragmented_.pop_front();
  return std::nullopt;
}

namespace {

std::array<std::atomic<std::uint64_t>, kRtpsFaults> refused{};

bool is_power_of_ten(std::uint64_t count) {
  while (count % 10 == 0) count /= 10;
  return count == 1;
}

// An IPv4 address is at the end of a locator's 16 bytes.
std::string text_of(const DatagramGuard::Address& from) {
  std::string text;
  for (std::size_t i = from.size() - 4; i < from.size(); ++i)
    text += (text.empty() ? "" : ".") + std::to_string(from[i]);
  return text;
}

}  // namespace

RtpsFaultCounts refused_datagrams() {
  RtpsFaultCounts counts{};
  for (std::size_t i = 0; i < kRtpsFaults; ++i) counts[i] = refused[i];
  return counts;
}

DatagramGuard::Verdict SharedGuard::check(std::span<const std::uint8_t> datagram,
                                          const DatagramGuard::Address& from,
                                          DatagramGuard::Bytes& scratch) {
  const Instant now{std::chrono::steady_clock::now().time_since_epoch()};
  DatagramGuard::Verdict verdict = [&] {
    const std::lock_guard lock(mutex_);
    return guard_.check(datagram, from, now, scratch);
  }();
  if (!verdict.fault) return verdict;
  const std::uint64_t count = ++refused[static_cast<std::size_t>(*verdict.fault)];
  if (is_power_of_ten(count)) {
    say_security(false, "refused a datagram of " + text_of(from) + " before DDS reads it: " +
                            std::string(to_text(*verdict.fault)) + ", " + std::to_string(count) +
                            " so far; docs/security.md explains the causes");
  }
  return verdict;
}

}  // namespace fieldcast
