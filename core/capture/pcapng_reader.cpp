#include "core/capture/pcapng_reader.hpp"

#include <algorithm>

#include "core/capture/pcapng.hpp"

namespace fieldcast::pcapng {
namespace {

constexpr std::size_t kHeader = 8;    // type and length of a block
constexpr std::size_t kAround = 12;   // with the length at its end
constexpr std::size_t kSection = 28;  // smallest section header
constexpr std::uint32_t kSwapped = 0x4D3C2B1A;
constexpr std::uint64_t kNanoseconds = 1'000'000'000;

std::size_t padded(std::size_t size) { return (size + 3) / 4 * 4; }

bool is_old(std::uint32_t magic) {
  const auto swapped =
      (magic >> 24) | (magic >> 8 & 0xFF00) | (magic << 8 & 0xFF0000) | magic << 24;
  return magic == kOldPcapMagic || magic == kOldPcapNanoMagic || swapped == kOldPcapMagic ||
         swapped == kOldPcapNanoMagic;
}

// 10^-n, or 2^-n with the highest bit. Values beyond 64 bits count as nanoseconds.
std::uint64_t units_of(std::uint8_t resolution) {
  const unsigned power = resolution & 0x7F;
  if (resolution & 0x80) return power < 63 ? std::uint64_t{1} << power : kNanoseconds;
  std::uint64_t units = 1;
  for (unsigned i = 0; i < power && i <= 18; ++i) units *= 10;
  return power <= 18 ? units : kNanoseconds;
}

UtcTime time_of(std::uint64_t units, const Interface& interface) {
  const std::uint64_t seconds = units / interface.units_per_second;
  const long double rest = static_cast<long double>(units % interface.units_per_second);
  constexpr std::uint64_t kMaxSeconds = 9'000'000'000;  // nanoseconds since 1970 have 64 bits
  const auto whole = static_cast<std::int64_t>(std::min(seconds, kMaxSeconds));
  const auto offset = std::clamp<std::int64_t>(interface.offset_seconds, -whole, 200'000'000);
  return {(whole + offset) * static_cast<std::int64_t>(kNanoseconds) +
          static_cast<std::int64_t>(rest * kNanoseconds / interface.units_per_second)};
}

}  // namespace

std::string_view to_text(Fault fault) {
  switch (fault) {
    case Fault::kNoCapture: return "is no pcapng file";
    case Fault::kOldFormat: return "is a pcap file; save it as pcapng in Wireshark";
    case Fault::kBroken: return "has a block whose lengths do not fit together";
    case Fault::kTooLong: return "has a block of more than 1 MiB";
    case Fault::kCut: return "is cut in the middle of a block";
  }
  return "?";
}

std::uint16_t Reader::u16(ByteView bytes, std::size_t at) const {
  return static_cast<std::uint16_t>(big_endian_ ? bytes[at] << 8 | bytes[at + 1]
                                                : bytes[at + 1] << 8 | bytes[at]);
}
std::uint32_t Reader::u32(ByteView bytes, std::size_t at) const {
  const std::uint32_t first = u16(bytes, at), second = u16(bytes, at + 2);
  return big_endian_ ? first << 16 | second : second << 16 | first;
}

template <typename Take>
void Reader::options(ByteView body, const Take& take) const {
  while (body.size() >= 4) {
    const std::uint16_t code = u16(body, 0);
    const std::size_t length = u16(body, 2);
    body = body.subspan(4);
    if (code == kEndOfOptions || length > body.size()) return;
    take(code, body.subspan(0, length));
    body = body.subspan(std::min(padded(length), body.size()));
  }
}

// The byte order of a section is written after the length of its header.
tl::expected<void, Fault> Reader::read_section() {
  const std::size_t known = block_.size();
  block_.resize(kAround);
  const std::size_t received = source_(block_.data() + known, kAround - known);
  if (received < kAround - known) return tl::unexpected(begun_ ? Fault::kCut : Fault::kNoCapture);
  big_endian_ = false;
  const std::uint32_t magic = u32(block_, kHeader);
  if (magic != kByteOrderMagic && magic != kSwapped)
    return tl::unexpected(begun_ ? Fault::kBroken : Fault::kNoCapture);
  big_endian_ = magic == kSwapped;
  begun_ = true;
  interfaces_.clear();
  return {};
}

tl::expected<std::optional<Reader::Block>, Fault> Reader::read_block() {
  offset_ = next_offset_;
  block_.resize(kHeader);
  const std::size_t received = source_(block_.data(), kHeader);
  if (received == 0 && begun_) return std::nullopt;
  if (received < kHeader) return tl::unexpected(begun_ ? Fault::kCut : Fault::kNoCapture);
  const std::uint32_t type = u32(block_, 0);
  if (!begun_ && type != kSectionHeader)
    return tl::unexpected(is_old(type) ? Fault::kOldFormat : Fault::kNoCapture);
  if (type == kSectionHeader) {
    if (const auto read = read_section(); !read) return tl::unexpected(read.error());
  }
  const std::size_t length = u32(block_, 4);
  const std::size_t least = type == kSectionHeader ? kSection : kAround;
  if (length > kMaxBlock) return tl::unexpected(Fault::kTooLong);
  if (length < least || length % 4 != 0) return tl::unexpected(Fault::kBroken);
  const std::size_t known = block_.size();
  block_.resize(length);
  if (source_(block_.data() + known, length - known) < length - known)
    return tl::unexpected(Fault::kCut);
  if (u32(block_, length - 4) != length) return tl::unexpected(Fault::kBroken);
  next_offset_ += length;
  return Block{type, ByteView(block_).subspan(kHeader, length - kAround)};
}

std::optional<Fault> Reader::add_interface(ByteView body) {
  if (body.size() < 8 || interfaces_.size() == kMaxInterfaces) return Fault::kBroken;
  Interface made{.linktype = u16(body, 0)};
  options(body.subspan(8), [&](std::uint16_t code, ByteView value) {
    if (code == kIfName) made.name.assign(value.begin(), value.end());
    if (code == kIfTsresol && value.size() == 1) made.units_per_second = units_of(value[0]);
    if (code == kIfTsoffset && value.size() == 8) {
      const std::uint64_t low = u32(value, big_endian_ ? 4 : 0);
      const std::uint64_t high = u32(value, big_endian_ ? 0 : 4);
      made.offset_seconds = static_cast<std::int64_t>(high << 32 | low);
    }
  });
  interfaces_.push_back(std::move(made));
  return std::nullopt;
}

// Interface, time, captured and original length, bytes, options.
tl::expected<ReadPacket, Fault> Reader::enhanced(ByteView body) const {
  if (body.size() < 20) return tl::unexpected(Fault::kBroken);
  const std::size_t interface = u32(body, 0), kept = u32(body, 12), original = u32(body, 16);
  if (interface >= interfaces_.size() || kept > body.size() - 20)
    return tl::unexpected(Fault::kBroken);
  ReadPacket packet{.interface = interfaces_[interface]};
  packet.at =
      time_of(static_cast<std::uint64_t>(u32(body, 4)) << 32 | u32(body, 8), packet.interface);
  const ByteView data = body.subspan(20, kept);
  packet.data.assign(data.begin(), data.end());
  packet.cut = kept < original;
  const std::size_t end = std::min(20 + padded(kept), body.size());
  options(body.subspan(end), [&](std::uint16_t code, ByteView value) {
    if (code == kPacketFlags && value.size() == 4) {
      const std::uint32_t direction = u32(value, 0) & 3;
      if (direction == kInbound) packet.direction = Direction::kReceived;
      if (direction == kOutbound) packet.direction = Direction::kSent;
    }
    if (code != kComment) return;
    if (!packet.comment.empty()) packet.comment += '\n';
    packet.comment.append(value.begin(), value.end());
  });
  return packet;
}

// The original length and the bytes; of the first interface, without a time.
tl::expected<ReadPacket, Fault> Reader::simple(ByteView body) const {
  if (body.size() < 4 || interfaces_.empty()) return tl::unexpected(Fault::kBroken);
  ReadPacket packet{.interface = interfaces_.front()};
  const std::size_t original = u32(body, 0), kept = std::min(original, body.size() - 4);
  const ByteView data = body.subspan(4, kept);
  packet.data.assign(data.begin(), data.end());
  packet.cut = kept < original;
  return packet;
}

void Reader::add_statistics(ByteView body) {
  if (body.size() < 12) return;
  options(body.subspan(12), [&](std::uint16_t code, ByteView value) {
    if (code == kIfDropped && value.size() == 8)
      dropped_ += u32(value, big_endian_ ? 4 : 0) |
                  static_cast<std::uint64_t>(u32(value, big_endian_ ? 0 : 4)) << 32;
  });
}

tl::expected<std::optional<ReadPacket>, Fault> Reader::next() {
  for (;;) {
    const auto block = read_block();
    if (!block) return tl::unexpected(block.error());
    if (!*block) return std::nullopt;
    const auto& [type, body] = **block;
    if (type == kInterfaceDescription) {
      if (const auto fault = add_interface(body)) return tl::unexpected(*fault);
    } else if (type == kInterfaceStatistics) {
      add_statistics(body);
    } else if (type == kEnhancedPacket || type == kSimplePacket) {
      auto packet = type == kEnhancedPacket ? enhanced(body) : simple(body);
      if (!packet) return tl::unexpected(packet.error());
      return std::move(*packet);
    }
  }
}

}  // namespace fieldcast::pcapng
