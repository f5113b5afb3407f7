#include "core/protocol/dtc/message.hpp"

#include <algorithm>
#include <string>

#include "core/base/message_text.hpp"
#include "core/codec/checksum.hpp"
#include "core/protocol/option_reader.hpp"
#include "core/protocol/received.hpp"

namespace fieldcast::dtc {

namespace {

constexpr std::string_view kAllowed =
    "bit:N, int16:N, int32:N, float32:N, float64:N with N 0..65535, or int16:N.BIT, int32:N.BIT "
    "for a bit of an integer";

constexpr AddressFaults address_fault{kAllowed};

}  // namespace

ParsedOrFault parse_address(std::string_view at) {
  const std::size_t colon = at.find(':');
  const std::string_view name = at.substr(0, colon);
  const auto found = std::ranges::find(kTypeNames, name);
  if (colon == std::string_view::npos || found == kTypeNames.end()) {
    const std::string_view near = near_miss(name, kTypeNames);
    const std::string rest(colon == std::string_view::npos ? ":0" : at.substr(colon));
    return address_fault("type " + in_quotes(name) + " is unknown",
                         near.empty() || rest.size() > 16 ? "" : std::string(near) + rest);
  }
  ParsedAddress address{.area = static_cast<AreaIndex>(found - kTypeNames.begin())};
  const unsigned bits = kTypeBits[address.area];
  const std::string_view number = at.substr(colon + 1);
  const std::size_t dot = number.find('.');
  const auto first = whole_number(number.substr(0, dot));
  if (!first)
    return address_fault(in_quotes(number.substr(0, dot)) + " is no number",
                         std::string(name) + ":0");
  if (*first >= kVariables)
    return address_fault(in_quotes(at) + " is beyond the end of " + std::string(name),
                         std::string(name) + ":65535");
  address.first = *first;
  if (dot == std::string_view::npos) {
    // Floating-point numbers are whole; a value may consist of several integers.
    if (address.area == kBit || address.area == kFloat32 || address.area == kFloat64)
      address.width_bits = bits;
    return address;
  }
  const std::string whole(at.substr(0, colon + 1 + dot));
  if (address.area != kInt16 && address.area != kInt32)
    return address_fault(in_quotes(at) + " has no bits", whole);
  if (!set_bit(address, whole_number(number.substr(dot + 1)), bits)) {
    return address_fault(
        "bit " + in_quotes(number.substr(dot + 1)) + " is not 0.." + std::to_string(bits - 1),
        whole + ".0");
  }
  return address;
}

namespace {

bool fits(const Range& range) {
  return range.area < kTypeCount && range.count >= 1 && range.count <= 0xFFFF &&
         range.first < kVariables && range.count <= kVariables - range.first;
}

void append_group(Bytes& out, const Range& range) {
  append_u16(out, static_cast<std::uint16_t>(range.first));
  out.push_back(range.area);
  append_u16(out, static_cast<std::uint16_t>(range.count));
}

// The response to one group of 33 to 40 bits is as long as its request and can equal it, as an echo
// would. Two groups have the same data.
constexpr std::uint32_t kFirstPart = 32;
bool is_split(const ReadRequest& read) {
  const Range& range = read.ranges.front();
  return read.ranges.size() == 1 && range.area == kBit &&
         data_bytes(kBit, range.count) == kGroupHead;
}

Bytes image_of(const Range& range, ByteView data) {
  return range.area == kBit ? unpack_bits(data, range.count) : Bytes(data.begin(), data.end());
}

}  // namespace

std::optional<MessageSizes> message_sizes(const Request& request, std::size_t longest) {
  MessageSizes sizes{kMessageHead + kCrcBytes, kMessageHead + kCrcBytes};
  if (const auto* read = std::get_if<ReadRequest>(&request)) {
    if (read->ranges.empty()) return std::nullopt;
    for (const Range& range : read->ranges) {
      if (!fits(range)) return std::nullopt;
      sizes.request += kGroupHead;
      sizes.response += data_bytes(range.area, range.count);
    }
    if (is_split(*read)) sizes.request += kGroupHead;
  } else if (const auto* write = std::get_if<WriteRequest>(&request)) {
    const Range& range = write->range;
    if (!fits(range) || write->bit ||
        write->items.size() != image_bytes(kTypeBits[range.area], range.count))
      return std::nullopt;
    sizes.request += kGroupHead + data_bytes(range.area, range.count);
  } else {
    return std::nullopt;
  }
  if (sizes.request > longest || sizes.response > longest) return std::nullopt;
  return sizes;
}

Bytes message_of(std::uint8_t address, const Request& request) {
  Bytes message{address, kRead};
  if (const auto* write = std::get_if<WriteRequest>(&request)) {
    message[1] = kWrite;
    append_group(message, write->range);
    if (write->range.area == kBit)
      append_bits(message, write->items);
    else
      append(message, write->items);
  } else {
    const auto& read = std::get<ReadRequest>(request);
    if (is_split(read)) {
      const Range& whole = read.ranges.front();
      append_group(message, {kBit, whole.first, kFirstPart});
      append_group(message, {kBit, whole.first + kFirstPart, whole.count - kFirstPart});
    } else {
      for (const Range& range : read.ranges) append_group(message, range);
    }
  }
  append_crc16(message);
  return message;
}

Reply reply_of(const Request& request, ByteView data) {
  const auto* read = std::get_if<ReadRequest>(&request);
  if (read == nullptr) return Reply(1);
  Reply reply;
  reply.reserve(read->ranges.size());
  for (const Range& range : read->ranges) {
    const std::size_t size = data_bytes(range.area, range.count);
    reply.push_back({.items = image_of(range, data.first(size))});
    data = data.subspan(size);
  }
  return reply;
}

std::string_view refusal_text(std::uint8_t code) {
  const auto text = device_code_text(kRefusals, code);
  return text.empty() ? "no such code" : text;
}

std::size_t group_size(ByteView bytes, bool with_data) {
  if (bytes.size() < kGroupHead || bytes[2] >= kTypeCount) return 0;
  const std::size_t data = with_data ? data_bytes(bytes[2], read_u16(bytes, 3)) : 0;
  return kGroupHead + data <= bytes.size() ? kGroupHead + data : 0;
}

bool inside(ByteView group) {
  return read_u16(group) + std::size_t{read_u16(group, 3)} <= kVariables;
}

bool all_groups(ByteView bytes, bool with_data) {
  if (bytes.empty()) return false;
  while (!bytes.empty()) {
    const std::size_t size = group_size(bytes, with_data);
    if (size == 0 || read_u16(bytes, 3) == 0) return false;
    if (!with_data && !inside(bytes)) return false;
    bytes = bytes.subspan(size);
  }
  return true;
}

}  // namespace fieldcast::dtc
