#include "core/model/reach.hpp"

#include <algorithm>
#include <cmath>

#include "core/base/value.hpp"

namespace fieldcast {
namespace {

std::string number(double value) { return to_text(Value{value}); }

std::vector<std::string> unreachable(const Limits& limits, const ValueSpan& span) {
  struct Row {
    const char* name;
    const std::optional<double>* limit;
    bool is_high;
  };
  const Row rows[] = {{"low-low", &limits.low_low, false},
                      {"low", &limits.low, false},
                      {"high", &limits.high, true},
                      {"high-high", &limits.high_high, true}};
  // The ends of a scaled span are rounded.
  const double rounding = 1e-12 * (span.greatest - span.least);
  std::vector<std::string> texts;
  for (const auto& [name, limit, is_high] : rows) {
    if (!*limit) continue;
    if (is_high ? **limit < span.greatest - rounding : **limit > span.least + rounding) continue;
    texts.push_back(std::string("no value is ") + (is_high ? "above" : "below") + " the limit '" +
                    name + "' " + number(**limit) + "; its type has " + number(span.least) +
                    " to " + number(span.greatest));
  }
  return texts;
}

}  // namespace

std::optional<ValueSpan> span_of(const Encoding& encoding) {
  double least = 0, greatest = 0;
  const int width = static_cast<int>(width_bits(Encoding{.type = encoding.type}));
  if (encoding.exponent_distance != 0) return std::nullopt;
  switch (encoding.type) {
    case ValueType::kInt8:
    case ValueType::kInt16:
    case ValueType::kInt32:
    case ValueType::kInt64:
      least = -std::ldexp(1.0, width - 1);
      greatest = -least - 1;
      break;
    case ValueType::kUint8:
    case ValueType::kUint16:
    case ValueType::kUint32:
    case ValueType::kUint64: greatest = std::ldexp(1.0, width) - 1; break;
    case ValueType::kBcd8: greatest = 99; break;
    case ValueType::kBcd16: greatest = 9'999; break;
    case ValueType::kBcd32: greatest = 99'999'999; break;
    default: return std::nullopt;
  }
  const auto [lower, upper] = std::minmax(
      {least * encoding.scale + encoding.offset, greatest * encoding.scale + encoding.offset});
  return ValueSpan{lower, upper};
}

std::vector<std::string> unreachable_limits(const BusSpec& bus) {
  std::vector<std::string> found;
  for (const DeviceSpec& device : bus.devices) {
    for (const ChannelSpec& channel : device.channels) {
      const auto span = channel.calculation ? std::nullopt : span_of(channel.encoding);
      if (!span) continue;
      for (const std::string& text : unreachable(channel.limits, *span))
        found.push_back(device.name + '/' + channel.name + ": " + text);
    }
  }
  return found;
}

}  // namespace fieldcast
