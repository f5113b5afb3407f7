#include "tools/sim/device/waveform.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <numbers>
#include <string>

namespace fieldcast::sim {
namespace {

struct Bounds {
  double low, high;
};

Bounds type_bounds(ValueType type) {
  switch (type) {
    case ValueType::kBool: return {0, 1};
    case ValueType::kInt8: return {-128, 127};
    case ValueType::kUint8: return {0, 255};
    case ValueType::kBcd8: return {0, 99};
    case ValueType::kInt16: return {-32768, 32767};
    case ValueType::kUint16: return {0, 65535};
    case ValueType::kBcd16: return {0, 9999};
    case ValueType::kInt32: return {-2147483648.0, 2147483647.0};
    case ValueType::kUint32: return {0, 4294967295.0};
    case ValueType::kBcd32: return {0, 99999999};
    case ValueType::kInt64: return {-9e15, 9e15};  // integers that a double represents exactly
    case ValueType::kUint64: return {0, 9e15};
    default: return {-1e9, 1e9};
  }
}

std::uint64_t bcd(std::uint64_t number) {
  std::uint64_t digits = 0;
  for (unsigned shift = 0; number != 0; shift += 4, number /= 10) digits |= (number % 10) << shift;
  return digits;
}

std::uint64_t raw_bits(ValueType type, double number) {
  const auto whole = static_cast<std::int64_t>(std::llround(number));
  switch (type) {
    case ValueType::kFloat32: return std::bit_cast<std::uint32_t>(static_cast<float>(number));
    case ValueType::kFloat64: return std::bit_cast<std::uint64_t>(number);
    case ValueType::kBcd8:
    case ValueType::kBcd16:
    case ValueType::kBcd32: return bcd(static_cast<std::uint64_t>(whole));
    case ValueType::kBool: return whole != 0 ? 1 : 0;
    default: return static_cast<std::uint64_t>(whole);
  }
}

std::uint16_t swapped(std::uint16_t word) {
  return static_cast<std::uint16_t>(word << 8 | word >> 8);
}

int decimals_of(const Encoding& encoding) {
  if (encoding.text_number.decimals >= 0) return encoding.text_number.decimals;
  const bool real = encoding.type == ValueType::kFloat32 || encoding.type == ValueType::kFloat64;
  return real && encoding.string_bytes >= 5 ? 2 : 0;
}

std::string spelt_number(double number, const Encoding& encoding) {
  const TextNumber& form = encoding.text_number;
  const int width = encoding.string_bytes;
  char text[320];
  if (form.kind == TextNumber::Kind::kHex) {
    const std::uint64_t bits = raw_bits(encoding.type, number);
    const unsigned unused = 64 - waveform_bits({.type = encoding.type});
    std::snprintf(text, sizeof text, "%0*llX", width,
                  static_cast<unsigned long long>(bits << unused >> unused));
    return text;
  }
  const char* format = form.leading_zeros ? (form.plus ? "%+0*.*f" : "%0*.*f") : "%*.*f";
  std::snprintf(text, sizeof text, format, width, decimals_of(encoding), number);
  std::string shown(text);
  if (form.kind == TextNumber::Kind::kDecimalComma) std::ranges::replace(shown, '.', ',');
  return shown;
}

// The second `number` of January 2026 in the CPU's own format. The 1st was a Thursday, day 5.
std::string date_of(TextLayout layout, unsigned number) {
  const unsigned day = number / 86400, hour = number / 3600 % 24, minute = number / 60 % 60,
                 second = number % 60, weekday = (4 + day) % 7 + 1;
  const auto text = [](std::initializer_list<unsigned> bytes) {
    return std::string(bytes.begin(), bytes.end());
  };
  if (layout == TextLayout::kDtl)
    return text({2026 / 256, 2026 % 256, 1, day + 1, weekday, hour, minute, second, 0, 0, 0, 0});
  const auto pair = [](unsigned value) { return value / 10 * 16 + value % 10; };
  return text({0x26, 0x01, pair(day + 1), pair(hour), pair(minute), pair(second), 0, weekday});
}

std::vector<std::uint16_t> text_items(const Waveform& waveform, const Encoding& encoding,
                                      Duration since_start) {
  char text[32];
  std::snprintf(text, sizeof text, "LOT-%05u",
                static_cast<unsigned>(waveform.at(since_start)) % 100000u);
  std::string padded(encoding.text_number ? spelt_number(waveform.at(since_start), encoding)
                                          : text);
  padded.resize(encoding.string_bytes);  // truncated or padded with zeros
  const bool dated =
      encoding.layout == TextLayout::kDtl || encoding.layout == TextLayout::kDateAndTime;
  if (dated) padded = date_of(encoding.layout, static_cast<unsigned>(waveform.at(since_start)));
  if (encoding.layout == TextLayout::kCounted)
    padded.insert(0, {static_cast<char>(encoding.string_bytes),
                      static_cast<char>(std::min(std::strlen(text), padded.size()))});
  if (padded.size() % 2 != 0) padded.push_back('\0');
  std::vector<std::uint16_t> items;
  for (std::size_t i = 0; i < padded.size(); i += 2) {
    items.push_back(static_cast<std::uint16_t>(static_cast<std::uint8_t>(padded[i]) << 8 |
                                               static_cast<std::uint8_t>(padded[i + 1])));
  }
  return items;
}

double most_in_text(const Encoding& encoding) {
  if (encoding.text_number.kind == TextNumber::Kind::kHex)
    return std::pow(16.0, std::min<int>(encoding.string_bytes, 6)) - 1;
  const int decimals = decimals_of(encoding);
  const int behind = decimals > 0 ? decimals + 1 : 0;
  const int digits = encoding.string_bytes - behind - (encoding.text_number.plus ? 1 : 0);
  return std::pow(10.0, std::clamp(digits, 0, 9)) - 1;
}

// Smooth noise: random heights at whole periods, interpolated with easing.
double walk(std::uint64_t seed, double turns) {
  const double whole = std::floor(turns);
  const double part = turns - whole;
  const auto height = [&](double index) {
    return static_cast<double>(mix(seed, static_cast<std::uint64_t>(index)) >> 11) /
           static_cast<double>(1ULL << 53);
  };
  const double ease = part * part * (3 - 2 * part);
  return height(whole) * (1 - ease) + height(whole + 1) * ease;
}

}  // namespace

std::uint64_t mix(std::uint64_t seed, std::uint64_t salt) {
  std::uint64_t z = seed + 0x9E3779B97F4A7C15ULL * (salt + 1);
  z = (z ^ (z >> 30)) * 0xBF58476D1CE4E5B9ULL;
  z = (z ^ (z >> 27)) * 0x94D049BB133111EBULL;
  return z ^ (z >> 31);
}

std::uint64_t mix(std::uint64_t seed, std::string_view salt) {
  for (const char c : salt) seed = mix(seed, static_cast<std::uint8_t>(c));
  return mix(seed, salt.size());
}

double Waveform::at(Duration since_start) const {
  const double phase = static_cast<double>(seed % 997) / 997.0;
  const double turns = std::max(0.0, to_seconds(since_start)) / to_seconds(period) + phase;
  const double part = turns - std::floor(turns);
  const double span = high - low;
  switch (shape) {
    case Shape::kSine: return low + span * (0.5 + 0.5 * std::sin(2 * std::numbers::pi * part));
    case Shape::kRamp: return low + span * part;
    case Shape::kCounter: return low + std::fmod(std::floor(turns * 100), std::floor(span) + 1);
    case Shape::kWalk: return low + span * walk(seed, turns);
    case Shape::kSquare: return part < 0.5 ? low : high;
    case Shape::kConstant: return low + span * phase;
  }
  return low;
}

Waveform waveform_for(const ChannelSpec& channel, std::uint64_t seed) {
  Waveform wave;
  wave.seed = mix(seed, channel.name);
  wave.period = std::chrono::milliseconds{4000 + static_cast<std::int64_t>(wave.seed % 20000)};
  const Encoding& encoding = channel.encoding;
  const Bounds type = type_bounds(encoding.type);
  wave.high = std::min(1000.0, type.high);
  switch (encoding.type) {
    case ValueType::kBool: wave.shape = Shape::kSquare; return wave;
    case ValueType::kString:
      wave.shape = Shape::kCounter;
      wave.high = 99999;
      wave.period = std::chrono::seconds{500};  // a new lot every five seconds
      return wave;
    case ValueType::kFloat32:
    case ValueType::kFloat64: wave.shape = wave.seed % 2 == 0 ? Shape::kSine : Shape::kWalk; break;
    default: {
      constexpr Shape kShapes[] = {Shape::kSine, Shape::kRamp, Shape::kCounter, Shape::kWalk};
      wave.shape = kShapes[wave.seed % 4];
    }
  }
  const auto low = channel.write_min    ? channel.write_min
                   : channel.limits.low ? channel.limits.low
                                        : channel.limits.low_low;
  const auto high = channel.write_max     ? channel.write_max
                    : channel.limits.high ? channel.limits.high
                                          : channel.limits.high_high;
  if (low && high && *low < *high && encoding.scale != 0) {
    const double power = channel.exponent_from.empty() ? 1 : std::pow(10.0, kSimulatedExponent);
    const double a = (*low - encoding.offset) / encoding.scale / power,
                 b = (*high - encoding.offset) / encoding.scale / power;
    wave.low = std::clamp(std::min(a, b), type.low, type.high);
    wave.high = std::clamp(std::max(a, b), type.low, type.high);
  }
  if (encoding.text_number) {
    const double most = most_in_text(encoding);
    wave.high = std::min(wave.high, most);
    wave.low = std::clamp(wave.low, -std::floor(most / 10), wave.high);
  }
  return wave;
}

Waveform exponent_waveform() {
  return {.shape = Shape::kConstant, .low = kSimulatedExponent, .high = kSimulatedExponent};
}

Encoding exponent_encoding(const ChannelSpec& channel) {
  return {.type = ValueType::kInt16, .byte_order = channel.encoding.byte_order};
}

std::uint32_t waveform_bits(const Encoding& encoding) {
  if (encoding.layout == TextLayout::kDtl) return 96;
  if (encoding.layout == TextLayout::kDateAndTime) return 64;
  if (encoding.is_text())
    return 8u * encoding.string_bytes + (encoding.layout == TextLayout::kCounted ? 16 : 0);
  switch (encoding.type) {
    case ValueType::kBool: return 1;
    case ValueType::kInt8:
    case ValueType::kUint8:
    case ValueType::kBcd8: return 8;
    default: return 16 * waveform_registers(encoding);
  }
}

std::uint32_t waveform_registers(const Encoding& encoding) {
  if (encoding.is_text()) return (waveform_bits(encoding) / 8 + 1) / 2;
  switch (encoding.type) {
    case ValueType::kInt32:
    case ValueType::kUint32:
    case ValueType::kFloat32:
    case ValueType::kBcd32: return 2;
    case ValueType::kInt64:
    case ValueType::kUint64:
    case ValueType::kFloat64: return 4;
    case ValueType::kString: return (encoding.string_bytes + 1u) / 2;
    default: return 1;
  }
}

std::vector<std::uint16_t> waveform_items(const Waveform& waveform, const Encoding& encoding,
                                          Duration since_start) {
  if (encoding.type == ValueType::kBool)
    return {static_cast<std::uint16_t>(raw_bits(ValueType::kBool, waveform.at(since_start)))};
  std::vector<std::uint16_t> items;
  if (encoding.is_text()) {
    items = text_items(waveform, encoding, since_start);
  } else {
    const std::uint64_t bits = raw_bits(encoding.type, waveform.at(since_start));
    for (std::uint32_t left = waveform_registers(encoding); left-- > 0;)
      items.push_back(static_cast<std::uint16_t>(bits >> (16 * left)));
    if (encoding.word_order == WordOrder::kLittleEndian) std::ranges::reverse(items);
  }
  if (encoding.byte_order == ByteOrder::kLittleEndian && waveform_bits(encoding) != 8)
    std::ranges::transform(items, items.begin(), swapped);
  return items;
}

}  // namespace fieldcast::sim
