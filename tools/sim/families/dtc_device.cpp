#include "tools/sim/families/dtc_device.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <charconv>
#include <map>
#include <utility>

#include "core/codec/checksum.hpp"
#include "tools/sim/device/device.hpp"

namespace fieldcast::sim {

namespace {

constexpr unsigned kFull = 4096;

int bits_of_code(unsigned k) { return std::bit_width(std::min(15 + k, kFull - 1)); }

}  // namespace

Bytes dtc_compress(ByteView message) {
  // (code of a string, next nibble) -> code of the longer string.
  std::map<std::pair<unsigned, unsigned>, unsigned> longer;
  Bytes out;
  unsigned next = 16, k = 0, room = 0;
  const auto emit = [&](unsigned code) {
    for (int bit = bits_of_code(k++) - 1; bit >= 0; --bit) {
      if (room == 0) out.push_back(0), room = 8;
      --room;
      out.back() = static_cast<std::uint8_t>(out.back() | (code >> bit & 1u) << room);
    }
  };
  std::optional<unsigned> string;
  for (std::size_t i = 0; i < 2 * message.size(); ++i) {
    const unsigned nibble = i % 2 == 0 ? message[i / 2] >> 4 : message[i / 2] & 15u;
    if (!string) {
      string = nibble;
    } else if (const auto found = longer.find({*string, nibble}); found != longer.end()) {
      string = found->second;
    } else {
      emit(*string);
      if (next < kFull) longer[{*string, nibble}] = next++;
      string = nibble;
    }
  }
  if (string) emit(*string);
  return out;
}

std::optional<Bytes> dtc_expand(ByteView codes, std::size_t length) {
  struct Entry {
    unsigned before;
    std::uint8_t last, first;
    unsigned size;
  };
  std::vector<Entry> entries;
  for (unsigned n = 0; n < 16; ++n)
    entries.push_back({0, static_cast<std::uint8_t>(n), static_cast<std::uint8_t>(n), 1});
  Bytes nibbles;
  std::size_t bit = 0;
  unsigned previous = 0;
  for (unsigned k = 0; nibbles.size() < 2 * length; ++k) {
    unsigned code = 0;
    for (int n = bits_of_code(k); n > 0; --n, ++bit) {
      if (bit / 8 >= codes.size()) return std::nullopt;
      code = code << 1 | (codes[bit / 8] >> (7 - bit % 8) & 1u);
    }
    // The encoder's last entry: the previous string and the first nibble of this one.
    if (k > 0 && entries.size() < kFull) {
      if (code > entries.size()) return std::nullopt;
      const Entry head = entries[previous];
      const std::uint8_t first = code < entries.size() ? entries[code].first : head.first;
      entries.push_back({previous, first, head.first, head.size + 1});
    }
    if (code >= entries.size() || entries[code].size > 2 * length - nibbles.size())
      return std::nullopt;
    nibbles.resize(nibbles.size() + entries[code].size);
    unsigned string = code;
    for (auto at = nibbles.end(); true; string = entries[string].before) {
      *--at = entries[string].last;
      if (entries[string].size == 1) break;
    }
    previous = code;
  }
  Bytes out;
  for (std::size_t i = 0; i < nibbles.size(); i += 2)
    out.push_back(static_cast<std::uint8_t>(nibbles[i] << 4 | nibbles[i + 1]));
  return out;
}

namespace {

constexpr std::size_t kHead = 3, kMostBytes = 4096, kLeastMessage = 4;
enum Refusal : std::uint8_t { kCommand = 1, kAddress, kType, kTooLong, kCount };

std::size_t size_of(std::uint8_t type, std::size_t count) {
  return (count * kDtcBits[type] + 7) / 8;
}

// After a packet without a valid flag the receiver waits for silence.
class DtcReceiver : public GapReceiver {
 public:
  DtcReceiver(DtcDevice& device, const LineFormat& line, bool stream)
      : GapReceiver(line, stream ? kStreamGap : line.characters(3.5)), device_(device) {}

  void on_character(std::uint8_t character, Instant end, Reaction& reaction) override {
    heard(end, reaction);
    if (lost_) return;
    received_.push_back(character);
    if (received_[0] > 1) return ready(true);
    if (received_.size() < kHead) return;
    const std::size_t length = read_u16(received_, 1);
    if (length < 3 || length > kMostBytes) return ready(true);
    if (received_.size() < kHead + length) return;
    ready(!device_.take(received_[0] == 1, ByteView(received_).subspan(kHead), end,
                        reaction.response));
  }

 private:
  DtcDevice& device_;
};

bool read_option(const DeviceLink& link, const char* name, std::size_t highest,
                 std::size_t& value) {
  const auto found = link.options.find(name);
  if (found == link.options.end() || found->second == "auto") return true;
  const std::string& text = found->second;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  return error == std::errc{} && end == text.data() + text.size() && value <= highest;
}

std::vector<ItemArea> dtc_areas() {
  std::vector<ItemArea> areas;
  for (std::size_t type = 0; type < kDtcAreaNames.size(); ++type)
    areas.push_back({kDtcAreaNames[type], kDtcBits[type], 65536});
  return areas;
}

}  // namespace

std::optional<ItemAddress> parse_dtc_address(std::string_view at) {
  const std::size_t colon = at.find(':'), dot = at.find('.');
  const auto name = std::ranges::find(kDtcAreaNames, at.substr(0, colon));
  if (colon == std::string_view::npos || name == kDtcAreaNames.end()) return std::nullopt;
  ItemAddress address{.area = static_cast<std::size_t>(name - kDtcAreaNames.begin())};
  const auto first =
      address_number(at.substr(colon + 1, dot == std::string_view::npos ? dot : dot - colon - 1));
  if (!first || *first > 65535) return std::nullopt;
  address.first = static_cast<std::uint32_t>(*first);
  if (dot == std::string_view::npos) return address;
  const bool integer = address.area == 1 || address.area == 2;
  const auto bit = address_number(at.substr(dot + 1));
  if (!integer || !bit || *bit >= kDtcBits[address.area]) return std::nullopt;
  address.bit = static_cast<std::uint8_t>(*bit);
  return address;
}

DtcDevice::DtcDevice(const DeviceSetup& setup)
    : MemoryDevice({dtc_areas(), setup}),
      address_(static_cast<std::uint8_t>(setup.spec.link.address)),
      line_(setup.line),
      stream_(setup.stream) {
  (void)read_option(setup.spec.link, "max-message", kMostBytes, max_message_);
  (void)read_option(setup.spec.link, "threshold", 65535, threshold_);
}

std::unique_ptr<Receiver> DtcDevice::open_receiver() {
  return std::make_unique<DtcReceiver>(*this, line_, stream_);
}

bool DtcDevice::take(bool compressed, ByteView body, Instant now, Bytes& response) {
  std::optional<Bytes> message(Bytes(body.begin(), body.end()));
  if (compressed) {
    const std::size_t length = read_u16(body);
    message = length <= kMostBytes ? dtc_expand(body.subspan(2), length) : std::nullopt;
  }
  if (!message || message->size() < kLeastMessage || !ends_with_crc16(*message)) {
    ++statistics_.bad_frames;
    return false;
  }
  const std::uint8_t command = (*message)[1];
  if ((*message)[0] != address_ || command >= 0x80) return true;
  ++statistics_.requests[command == 0 ? "read" : command == 1 ? "write" : "other"];
  response = packet(execute(*message, now));
  ++statistics_.responses;
  return true;
}

Bytes DtcDevice::execute(ByteView message, Instant now) {
  const std::uint8_t command = message[1];
  const auto refused = [&](std::uint8_t code) {
    ++statistics_.exceptions[code];
    return Bytes{address_, static_cast<std::uint8_t>(command | 0x80u), code};
  };
  if (command > 1) return refused(kCommand);
  if (message.size() > max_message_) return refused(kTooLong);
  const bool write = command == 1;
  const auto groups = groups_of(message.subspan(2, message.size() - 4), write);
  if (!groups) return refused(groups.error());
  std::size_t size = kLeastMessage;
  for (const Group& group : *groups) size += write ? 0 : size_of(group.type, group.count);
  if (size > max_message_) return refused(kTooLong);
  Bytes response{address_, command};
  for (const Group& group : *groups) write ? store(group) : append_values(group, now, response);
  if (write) ++statistics_.write_requests;
  return response;
}

tl::expected<std::vector<DtcDevice::Group>, std::uint8_t> DtcDevice::groups_of(ByteView bytes,
                                                                               bool write) const {
  std::vector<Group> groups;
  while (!bytes.empty()) {
    if (bytes.size() < 5) return tl::unexpected(std::uint8_t{kTooLong});
    Group group{.type = bytes[2], .first = read_u16(bytes, 0), .count = read_u16(bytes, 3)};
    if (const std::uint8_t code = refusal_of(group); code != 0) return tl::unexpected(code);
    bytes = bytes.subspan(5);
    const std::size_t size = write ? size_of(group.type, group.count) : 0;
    if (size > bytes.size()) return tl::unexpected(std::uint8_t{kTooLong});
    group.data = bytes.first(size);
    bytes = bytes.subspan(size);
    groups.push_back(group);
  }
  return groups;
}

std::uint8_t DtcDevice::refusal_of(const Group& group) const {
  if (group.type >= kDtcAreaNames.size()) return kType;
  if (group.count == 0) return kCount;
  return memory_.refusal(group.type, group.first, group.count, kAddress);
}

void DtcDevice::store(const Group& group) {
  const std::size_t width = kDtcBits[group.type] / 8;
  for (std::size_t i = 0; i < group.count; ++i) {
    std::uint64_t bits = group.type == 0 ? group.data[i / 8] >> i % 8 & 1u : 0u;
    for (std::size_t byte = 0; byte < width; ++byte)
      bits = bits << 8 | group.data[i * width + byte];
    memory_.write(group.type, static_cast<std::uint32_t>(group.first + i), bits, statistics_);
  }
}

void DtcDevice::append_values(const Group& group, Instant now, Bytes& out) const {
  for (std::size_t i = 0; i < group.count; ++i) {
    const std::uint64_t bits =
        memory_.read(group.type, static_cast<std::uint32_t>(group.first + i), now);
    if (group.type == 0) {
      if (i % 8 == 0) out.push_back(0);
      out.back() = static_cast<std::uint8_t>(out.back() | bits << i % 8);
    }
    for (unsigned left = kDtcBits[group.type] / 8; left-- > 0;)
      out.push_back(static_cast<std::uint8_t>(bits >> 8 * left));
  }
}

Bytes DtcDevice::packet(Bytes message) const {
  append_crc16(message);
  Bytes packet{0}, body = message;
  if (message.size() >= threshold_) {
    Bytes smaller;
    append_u16(smaller, static_cast<std::uint16_t>(message.size()));
    append(smaller, dtc_compress(message));
    if (smaller.size() < message.size()) packet = {1}, body = smaller;
  }
  append_u16(packet, static_cast<std::uint16_t>(body.size()));
  append(packet, body);
  return packet;
}

tl::expected<std::unique_ptr<SimDevice>, std::string> make_dtc_device(const DeviceSetup& setup) {
  const DeviceSpec& spec = setup.spec;
  std::size_t ignored = 0;
  for (const auto& [option, highest] :
       {std::pair{"max-message", kMostBytes}, std::pair{"threshold", std::size_t{65535}}}) {
    if (!read_option(spec.link, option, highest, ignored))
      return tl::unexpected(fmt::format("{}: option {} is no such number", spec.name, option));
  }
  return make_memory_device<DtcDevice>(setup, 255, parse_dtc_address);
}

}  // namespace fieldcast::sim
