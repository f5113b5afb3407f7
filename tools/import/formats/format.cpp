#include "tools/import/formats/format.hpp"

#include <algorithm>
#include <array>

namespace fieldcast::importing {

std::span<const Format> formats() {
  // The order decides between formats of the same confidence.
  static const std::array kFormats{kKepwareFormat, kTelegrafFormat, kMqmgatewayFormat, kEpicsFormat,
                                   kWbFormat,      kNeuronFormat,   kModbusListFormat};
  return kFormats;
}

const Format* format_by_name(std::string_view name) {
  const auto found = std::ranges::find(formats(), name, &Format::name);
  return found == formats().end() ? nullptr : &*found;
}

Recognised recognise(const SourceText& source) {
  Recognised best;
  for (const Format& format : formats()) {
    const Confidence confidence = format.recognise(source);
    if (confidence > best.confidence) best = {&format, confidence};
  }
  return best;
}

Device& device_at(Bus& bus, std::uint16_t address) {
  const auto known = std::ranges::find(bus.devices, address, &Device::address);
  if (known != bus.devices.end()) return *known;
  Device& device = bus.devices.emplace_back();
  device.address = address;
  return device;
}

Line line_at(const Node& map, const LineKeys& keys) {
  Line line;
  line.baud = small_at<std::uint32_t>(map, keys.baud, 0, 9'999'999);
  const std::string_view parity = text_at(map, keys.parity);
  line.format = fmt::format("{}{}{}", whole_at(map, keys.data_bits).value_or(8),
                            parity.empty() ? keys.usual_parity : parity[0],
                            whole_at(map, keys.stop_bits).value_or(1));
  return line;
}

std::string tcp_at(const Node& map, std::string_view host, std::string_view port) {
  return fmt::format("{}:{}", text_at(map, host), whole_at(map, port).value_or(502));
}

Confidence confidence_by(std::string_view text, std::initializer_list<Sign> signs) {
  for (const Sign& sign : signs) {
    const auto words = split(sign.words, ' ');
    if (std::ranges::all_of(words, [&](std::string_view word) { return contains(text, word); }))
      return sign.confidence;
  }
  return 0;
}

std::string_view to_text_of(Confidence confidence) {
  if (confidence >= kCertain) return "certainly";
  return confidence >= kLikely ? "probably" : "perhaps";
}

std::string stem_of(std::string_view path) {
  const std::size_t slash = path.rfind('/');
  if (slash != std::string_view::npos) path.remove_prefix(slash + 1);
  const std::size_t point = path.rfind('.');
  return std::string(point == 0 ? path : path.substr(0, point));
}

}  // namespace fieldcast::importing
