#include "tools/sim/dtc_memory.hpp"

#include <algorithm>
#include <charconv>

namespace fieldcast::sim {
namespace {

std::optional<std::uint32_t> number(std::string_view text, std::uint32_t limit) {
  std::uint32_t value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (text.empty() || error != std::errc{} || end != text.data() + text.size() || value > limit) return std::nullopt;
  return value;
}

bool is_signed(ValueType type) { return type == ValueType::kInt16 || type == ValueType::kInt32 || type == ValueType::kInt64; }

// Variables of `width` bits that a value takes; one wider than the value holds it alone.
unsigned variables_of(const Encoding& encoding, unsigned width) {
  const unsigned registers = waveform_registers(encoding), each = std::max(1u, width / 16);
  return (registers + each - 1) / each;
}

}  // namespace

std::optional<DtcAddress> parse_dtc_address(std::string_view at) {
  DtcAddress address;
  const std::size_t colon = at.find(':'), dot = at.find('.');
  const auto name = std::ranges::find(kDtcAreaNames, at.substr(0, colon));
  if (colon == std::string_view::npos || name == kDtcAreaNames.end()) return std::nullopt;
  address.type = static_cast<std::uint8_t>(name - kDtcAreaNames.begin());
  const auto first = number(at.substr(colon + 1, dot == std::string_view::npos ? dot : dot - colon - 1), 65535);
  if (!first) return std::nullopt;
  address.first = static_cast<std::uint16_t>(*first);
  if (dot == std::string_view::npos) return address;
  const bool integer = address.type == 1 || address.type == 2;
  const auto bit = number(at.substr(dot + 1), kDtcBits[address.type] - 1);
  if (!integer || !bit) return std::nullopt;
  address.bit = static_cast<std::uint8_t>(*bit);
  return address;
}

bool DtcMemory::add_channel(const DtcAddress& at, const Encoding& encoding, const Waveform& waveform) {
  if (at.type == 0 && encoding.type != ValueType::kBool) return false;
  const unsigned count = variables_of(encoding, kDtcBits[at.type]);
  if (at.first + count > kVariables) return false;
  DtcAddress place = at;
  if (!place.bit) place.bit = encoding.bit;
  channels_.push_back({place, encoding, waveform});
  for (unsigned i = 0; i < count; ++i) {
    parts_[at.type].emplace(static_cast<std::uint16_t>(at.first + i), Part{channels_.size() - 1, i});
  }
  return true;
}

std::uint64_t DtcMemory::bits_of(const Part& part, unsigned width, Instant now) const {
  const Channel& channel = channels_[part.channel];
  const auto registers = waveform_items(channel.waveform, channel.encoding, now - start_);
  if (channel.at.bit) return std::uint64_t{registers[0] != 0} << *channel.at.bit;
  const std::size_t each = std::max(1u, width / 16), begin = part.index * each;
  const std::size_t end = std::min(begin + each, registers.size());
  const bool negative = is_signed(channel.encoding.type) && (registers[begin] & 0x8000u) != 0;
  std::uint64_t bits = negative ? ~std::uint64_t{0} : 0;
  for (std::size_t i = begin; i < end; ++i) bits = bits << 16 | registers[i];
  return width == 64 ? bits : bits & ((std::uint64_t{1} << width) - 1);
}

std::uint64_t DtcMemory::read(std::uint8_t type, std::uint16_t variable, Instant now) const {
  if (const auto found = written_[type].find(variable); found != written_[type].end()) return found->second;
  std::uint64_t bits = 0;  // of several channels where each is one bit
  const auto [begin, end] = parts_[type].equal_range(variable);
  for (auto part = begin; part != end; ++part) bits |= bits_of(part->second, kDtcBits[type], now);
  return bits;
}

}  // namespace fieldcast::sim
