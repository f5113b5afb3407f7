#include "tools/cli/inspect/value_decoder.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <map>
#include <set>

#include "core/codec/value_codec.hpp"
#include "core/model/bus_spec.hpp"
#include "core/model/port_spec.hpp"

namespace fieldcast::cli {
namespace {

constexpr std::size_t kMaxKnown = 1024;      // stored requests
constexpr std::size_t kMaxResponse = 65536;  // bytes
constexpr std::uint32_t kMostLonger = 4;     // items that a read may have after its last channel
constexpr unsigned kSequences = 65536;

Bytes request_of(const Protocol& protocol, const std::vector<Range>& ranges,
                 std::uint16_t sequence) {
  Bytes out;
  (void)protocol.begin(ReadRequest{ranges}, {sequence})->start(out);
  return out;
}

// Ignores bytes that depend on the sequence number. Both digits of a XOR sum of hexadecimal digits
// change only if one of the numbers has a letter.
bool is_request_of(const Protocol& protocol, const std::vector<Range>& ranges, ByteView frame) {
  if (!protocol.size(ReadRequest{ranges})) return false;
  const Bytes one = request_of(protocol, ranges, 0);
  if (one.size() != frame.size()) return false;
  std::array<Bytes, 3> others;
  std::ranges::transform(std::array{0x5A13, 0xA0A0, 0x0B0B}, others.begin(), [&](int sequence) {
    return request_of(protocol, ranges, static_cast<std::uint16_t>(sequence));
  });
  for (std::size_t i = 0; i < frame.size(); ++i) {
    const bool depends =
        std::ranges::any_of(others, [&](const Bytes& other) { return other[i] != one[i]; });
    if (frame[i] != one[i] && !depends) return false;
  }
  return true;
}

// Searches the sequence number from `sequence` on, and sets it.
std::unique_ptr<Exchange> exchange_of(const Protocol& protocol, const std::vector<Range>& ranges,
                                      ByteView frame, std::uint16_t& sequence) {
  if (!is_request_of(protocol, ranges, frame)) return nullptr;
  for (unsigned i = 0; i < kSequences; ++i) {
    const auto next = static_cast<std::uint16_t>(sequence + i);
    if (!std::ranges::equal(request_of(protocol, ranges, next), frame)) continue;
    sequence = next;
    auto exchange = protocol.begin(ReadRequest{ranges}, {next});
    Bytes out;
    (void)exchange->start(out);
    return exchange;
  }
  return nullptr;
}

std::optional<std::uint32_t> number_from(std::string_view text) {
  std::uint32_t number = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (error != std::errc{} || end != text.data() + text.size()) return std::nullopt;
  return number;
}

// "holding:100..109"
std::optional<Range> range_from(std::string_view text, const Protocol& protocol) {
  const auto colon = text.rfind(':');
  if (colon == text.npos) return std::nullopt;
  const auto areas = protocol.areas();
  const auto area = std::ranges::find(areas, text.substr(0, colon), &Area::name);
  const std::string_view items = text.substr(colon + 1);
  const auto dots = items.find("..");
  const auto first = number_from(items.substr(0, dots));
  const auto last = dots == items.npos ? first : number_from(items.substr(dots + 2));
  if (area == areas.end() || !first || !last || *last < *first || *last - *first > 65535)
    return std::nullopt;
  return Range{static_cast<AreaIndex>(area - areas.begin()), *first, *last - *first + 1};
}

bool holds(const Range& outer, const Range& inner) {
  return outer.area == inner.area && outer.first <= inner.first && inner.end() <= outer.end();
}

}  // namespace

ValueDecoder::ValueDecoder(const BusSpec& bus) : bus_(bus), sequences_(bus.devices.size()) {
  const LineFormat line = line_of(bus_.port);
  for (const DeviceSpec& device : bus_.devices) {
    auto made = make_protocol(device, line);
    protocols_.push_back(made ? *std::move(made) : nullptr);
  }
}

// "press-1: read holding:100..109, coil:3 (oil-temperature, running, +3), try 2"
std::optional<ValueDecoder::Asked> ValueDecoder::from_comment(std::string_view comment) const {
  static constexpr std::string_view kRead = ": read ";
  const auto at = comment.find(kRead);
  if (at == comment.npos) return std::nullopt;
  const auto begin = comment.rfind('\n', at);
  const auto name = comment.substr(begin == comment.npos ? 0 : begin + 1,
                                   at - (begin == comment.npos ? 0 : begin + 1));
  const auto device = std::ranges::find(bus_.devices, name, &DeviceSpec::name);
  if (device == bus_.devices.end()) return std::nullopt;
  Asked asked{static_cast<std::size_t>(device - bus_.devices.begin()), {}};
  const Protocol* protocol = protocols_[asked.device].get();
  if (protocol == nullptr) return std::nullopt;
  std::string_view text = comment.substr(at + kRead.size());
  text = text.substr(0, std::min(text.find(" ("), text.find('\n')));
  while (!text.empty()) {
    const auto comma = text.find(", ");
    const auto range = range_from(text.substr(0, comma), *protocol);
    if (!range) return std::nullopt;
    asked.ranges.push_back(*range);
    text = comma == text.npos ? std::string_view{} : text.substr(comma + 2);
  }
  return asked.ranges.empty() ? std::nullopt : std::optional(asked);
}

std::optional<ValueDecoder::Asked> ValueDecoder::by_trial(std::size_t device, ByteView frame,
                                                          std::size_t& left) {
  const Protocol* protocol = protocols_[device].get();
  if (protocol == nullptr) return std::nullopt;
  std::map<AreaIndex, std::pair<std::set<std::uint32_t>, std::set<std::uint32_t>>> areas;
  for (const ChannelSpec& channel : bus_.devices[device].channels) {
    if (channel.calculation) continue;
    auto& [firsts, ends] = areas[channel.range.area];
    firsts.insert(channel.range.first);
    for (std::uint32_t i = 0; i <= kMostLonger; ++i) ends.insert(channel.range.end() + i);
  }
  for (const auto& [index, points] : areas) {
    const Area& area = protocol->areas()[index];
    const std::uint32_t align = area.alignment;
    for (const std::uint32_t item : points.first) {
      const std::uint32_t first = area.window ? 0 : item / align * align;
      for (auto end = points.second.upper_bound(first); end != points.second.end(); ++end) {
        if (left == 0) return std::nullopt;
        --left;
        const std::uint32_t count =
            area.window ? area.items : (*end - first + align - 1) / align * align;
        const std::vector<Range> ranges{{index, first, count}};
        if (!protocol->size(ReadRequest{ranges})) break;  // too long, as all further ends are
        if (is_request_of(*protocol, ranges, frame)) return Asked{device, ranges};
      }
    }
  }
  return std::nullopt;
}

std::optional<ValueDecoder::Asked> ValueDecoder::by_trial(ByteView frame) {
  for (const Asked& before : known_) {
    if (is_request_of(*protocols_[before.device], before.ranges, frame)) return before;
  }
  const Bytes key(frame.begin(), frame.end());
  if (unknown_.contains(key)) return std::nullopt;
  std::optional<Asked> found;
  std::size_t left = kMaxCandidates;
  for (std::size_t device = 0; !found && device < bus_.devices.size(); ++device)
    found = by_trial(device, frame, left);
  if (!found && unknown_.size() < kMaxKnown) unknown_.insert(key);
  if (found && known_.size() < kMaxKnown) known_.push_back(*found);
  return found;
}

bool ValueDecoder::begin(const Asked& asked, ByteView frame) {
  auto exchange =
      exchange_of(*protocols_[asked.device], asked.ranges, frame, sequences_[asked.device]);
  asked_ = asked.device;
  exchange_ = std::move(exchange);
  ranges_ = asked.ranges;
  received_.clear();
  next_.clear();
  return exchange_ != nullptr;
}

// Returns true for the next request of an exchange with several rounds.
bool ValueDecoder::goes_on(ByteView frame) {
  if (!exchange_) return false;
  if (next_.empty() && exchange_->on_silence(next_).kind != Step::Kind::kSend) next_.clear();
  const bool same = !next_.empty() && std::ranges::equal(next_, frame);
  next_.clear();
  received_.clear();
  return same;
}

std::vector<DecodedValue> ValueDecoder::take(Direction direction, ByteView frame,
                                             std::string_view comment) {
  if (comment.ends_with(kEchoComment)) return {};
  if (direction == Direction::kSent) {
    if (goes_on(frame)) return {};
    exchange_.reset();
    auto asked = from_comment(comment);
    if (!asked) asked = by_trial(frame);
    if (asked) (void)begin(*asked, frame);
    return {};
  }
  if (!exchange_ || received_.size() + frame.size() > kMaxResponse) return {};
  append(received_, frame);
  next_.clear();
  const Step step = exchange_->on_bytes(received_, next_);
  if (step.kind != Step::Kind::kDone) {
    if (step.kind == Step::Kind::kFailed) exchange_.reset();
    return {};
  }
  auto found = values();
  exchange_.reset();
  return found;
}

std::vector<DecodedValue> ValueDecoder::values() const {
  std::vector<DecodedValue> found;
  const DeviceSpec& device = bus_.devices[asked_];
  const Reply& reply = exchange_->reply();
  for (std::size_t i = 0; i < ranges_.size() && i < reply.size(); ++i) {
    if (reply[i].cause != Cause::kNone) continue;
    const unsigned bits = protocols_[asked_]->areas()[ranges_[i].area].item_bits;
    for (const ChannelSpec& channel : device.channels) {
      if (channel.calculation || !holds(ranges_[i], channel.range)) continue;
      const std::size_t first = image_bytes(bits, channel.range.first - ranges_[i].first);
      const std::size_t size = image_bytes(bits, channel.range.count);
      if (first + size > reply[i].items.size()) continue;
      const auto value =
          decode_value(channel.encoding, bits, ByteView(reply[i].items).subspan(first, size));
      if (value)
        found.push_back(
            {device.name, channel.name, *value, to_text(channel.encoding), channel.unit});
    }
  }
  return found;
}

}  // namespace fieldcast::cli
