#include "tools/sim/families/mc_device.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace fieldcast::sim {
namespace {

struct McArea {
  std::uint8_t code;
  unsigned bits, base;  // base of its numbers in addresses
  std::uint32_t items;
  std::string_view series_r;  // its name in ASCII code of the iQ-R series
};
constexpr std::array<McArea, kMcAreaNames.size()> kAreas{{
    {0xA8, 16, 10, 0x500000, "D"},  {0xB4, 16, 16, 0x500000, "W"},  {0xAF, 16, 10, 0x8000, "R"},
    {0xB0, 16, 10, 0xA00000, "ZR"}, {0xA9, 16, 10, 0x4000, "SD"},   {0xB5, 16, 16, 0x8000, "SW"},
    {0xCC, 16, 10, 32, "Z"},        {0xC2, 16, 10, 0x100000, "TN"}, {0xC8, 16, 10, 0x100000, "STN"},
    {0xC5, 16, 10, 0x100000, "CN"}, {0x90, 1, 10, 0x100000, "M"},   {0x92, 1, 10, 0x8000, "L"},
    {0x93, 1, 10, 0x8000, "F"},     {0x94, 1, 10, 0x8000, "V"},     {0xA0, 1, 16, 0x100000, "B"},
    {0x9C, 1, 16, 0x3000, "X"},     {0x9D, 1, 16, 0x3000, "Y"},     {0x91, 1, 10, 0x4000, "SM"},
    {0xA1, 1, 16, 0x8000, "SB"},    {0x98, 1, 10, 0x4000, "S"},     {0xC1, 1, 10, 0x100000, "TS"},
    {0xC0, 1, 10, 0x100000, "TC"},  {0xC7, 1, 10, 0x100000, "STS"}, {0xC6, 1, 10, 0x100000, "STC"},
    {0xC4, 1, 10, 0x100000, "CS"},  {0xC3, 1, 10, 0x100000, "CC"},
}};

constexpr std::size_t kZr = 3;  // hexadecimal in ASCII code

constexpr std::uint16_t kNotDigits = 0xC050, kManyBits = 0xC051, kManyWords = 0xC052,
                        kManyRandomBits = 0xC053, kManyRandomWords = 0xC054, kNoCommand = 0xC059,
                        kNoDevice = 0xC05B, kWrongUnits = 0xC05C, kBitValue = 0xC060,
                        kLengthDiffers = 0xC061;
constexpr std::string_view kMcModel = "Q03UDECPU";
constexpr std::uint16_t kMcCode = 0x0268;
constexpr std::uint16_t kCpuError = 0x4000;
constexpr std::uint8_t kOutside = 0x31;  // after 40
constexpr std::uint8_t kThree = 0x50, kFour = 0x54, kResponse = 0x80;
constexpr std::size_t kMostLength = 8000;

std::vector<ItemArea> mc_areas() {
  std::vector<ItemArea> areas;
  for (std::size_t area = 0; area < kAreas.size(); ++area)
    areas.push_back({kMcAreaNames[area], kAreas[area].bits, kAreas[area].items});
  return areas;
}

std::optional<std::size_t> area_named(std::string_view name) {
  for (std::size_t area = 0; area < kAreas.size(); ++area) {
    if (name == kMcAreaNames[area] || name == kAreas[area].series_r) return area;
  }
  return std::nullopt;
}

std::uint8_t option_number(const DeviceSetup& setup, const std::string& name) {
  const auto found = setup.spec.link.options.find(name);
  return found == setup.spec.link.options.end()
             ? std::uint8_t{0}
             : static_cast<std::uint8_t>(address_number(found->second).value_or(0));
}

bool option_is(const DeviceSetup& setup, const std::string& name, std::string_view value) {
  const auto found = setup.spec.link.options.find(name);
  return found != setup.spec.link.options.end() && found->second == value;
}

}  // namespace

std::optional<ItemAddress> parse_mc_address(std::string_view at) {
  const std::string_view whole = at.substr(0, at.find('.'));
  for (std::size_t letters : {3, 2, 1}) {
    const auto area = area_named(whole.substr(0, letters));
    if (!area || whole.size() <= letters) continue;
    const auto number = address_number(whole.substr(letters), static_cast<int>(kAreas[*area].base));
    if (!number) return std::nullopt;
    ItemAddress address{.area = *area, .first = static_cast<std::uint32_t>(*number)};
    if (whole.size() == at.size()) return address;
    const std::string_view bit = at.substr(whole.size() + 1);
    const bool letter = bit.size() == 1 && bit[0] >= 'A';
    const auto which = address_number(bit, letter ? 16 : 10);
    if (!which || *which >= kAreas[*area].bits || kAreas[*area].bits == 1) return std::nullopt;
    address.bit = static_cast<std::uint8_t>(*which);
    return address;
  }
  return std::nullopt;
}

// Reads a request field by field. After the first error all numbers are 0.
class McDevice::Text {
 public:
  Text(ByteView rest, bool ascii, bool series_r = false)
      : rest_(rest), ascii_(ascii), series_r_(series_r) {}

  std::uint32_t number(unsigned bytes) {
    const ByteView field = next(bytes * (ascii_ ? 2 : 1));
    if (ascii_) return digits(field, 16);
    std::uint32_t value = 0;
    for (std::size_t i = field.size(); i-- > 0;) value = value << 8 | field[i];
    return value;
  }

  std::optional<Place> device() {
    if (!ascii_) {
      const std::uint32_t number_part = number(series_r_ ? 4 : 3);
      const std::uint32_t code = number(series_r_ ? 2 : 1);
      const auto found = std::ranges::find(kAreas, code, &McArea::code);
      if (found == kAreas.end()) return std::nullopt;
      return Place{static_cast<std::size_t>(found - kAreas.begin()), number_part};
    }
    const ByteView name = next(series_r_ ? 4 : 2);
    std::string letters(name.begin(), name.end());
    letters.erase(std::min(letters.find('*'), letters.size()));
    const auto area = area_named(letters);
    const ByteView field = next(series_r_ ? 8 : 6);
    if (!area) return std::nullopt;
    return Place{*area, digits(field, *area == kZr ? 16 : kAreas[*area].base)};
  }

  // Bits of a write in bit units.
  Bytes bits(std::uint32_t count) {
    Bytes result;
    const ByteView field = next(ascii_ ? count : (count + 1) / 2);
    for (std::uint32_t i = 0; i < count && !field.empty(); ++i) {
      const unsigned pair = ascii_ ? digits(field.subspan(i, 1), 16) : field[i / 2];
      result.push_back(static_cast<std::uint8_t>(ascii_       ? pair
                                                 : i % 2 == 0 ? pair >> 4
                                                              : pair & 0x0Fu));
    }
    return result;
  }

  [[nodiscard]] std::uint16_t fault() const {
    return fault_ != 0 ? fault_ : rest_.empty() ? std::uint16_t{0} : kLengthDiffers;
  }
  [[nodiscard]] ByteView rest() const { return rest_; }
  [[nodiscard]] std::uint16_t field_fault() const { return fault_; }

 private:
  ByteView next(std::size_t size) {
    if (size > rest_.size()) fault_ = kLengthDiffers;
    if (fault_ != 0) return {};
    const ByteView field = rest_.first(size);
    rest_ = rest_.subspan(size);
    return field;
  }
  std::uint32_t digits(ByteView field, unsigned base) {
    if (fault_ != 0) return 0;
    const auto value = number_in(field, base);
    if (!value) fault_ = kNotDigits;
    return static_cast<std::uint32_t>(value.value_or(0));
  }

  ByteView rest_;
  const bool ascii_, series_r_;
  std::uint16_t fault_ = 0;
};

class McDevice::Connection : public GapReceiver {
 public:
  explicit Connection(McDevice& device) : GapReceiver(device.line_, kStreamGap), device_(device) {}

  void on_character(std::uint8_t character, Instant end, Reaction& reaction) override {
    heard(end, reaction);
    const std::size_t width = device_.ascii_ ? 2 : 1;
    received_.push_back(character);
    if (received_.size() < 2 * width) return;
    Text text(received_, device_.ascii_);
    const std::uint32_t first = text.number(1), zero = text.number(1);
    const bool response = (first & kResponse) != 0;  // of another station behind the connection
    const std::uint32_t kind = first & ~std::uint32_t{kResponse};
    if ((kind != kThree && kind != kFour) || zero != 0) return refuse(reaction);
    const std::size_t header = (kind == kFour ? 13 : 9) * width;
    if (received_.size() < header) return;
    Text length_text(ByteView(received_).subspan(header - 2 * width), device_.ascii_);
    const std::size_t length = length_text.number(2);
    if (length_text.field_fault() != 0 || length > kMostLength) return refuse(reaction);
    if (received_.size() < header + length) return;
    const Bytes frame = std::exchange(received_, {});
    if (!response) device_.answer(frame, end, reaction);
  }

 private:
  void refuse(Reaction& reaction) {
    ready(false);
    if (!device_.has_port_) return;
    ++device_.statistics_.bad_frames;
    reaction.hang_up = true;
  }

  McDevice& device_;
};

McDevice::McDevice(const DeviceSetup& setup) : McDevice(setup, option_is(setup, "code", "ascii")) {}

McDevice::McDevice(const DeviceSetup& setup, bool ascii)
    : MemoryDevice({mc_areas(), setup}),
      line_(setup.line),
      ascii_(ascii),
      station_(setup.spec.link.address == 0 ? std::uint8_t{0xFF}
                                            : static_cast<std::uint8_t>(setup.spec.link.address)),
      network_(option_number(setup, "network")),
      has_port_(setup.first_on_bus) {}

std::unique_ptr<Receiver> McDevice::open_receiver() { return std::make_unique<Connection>(*this); }

void McDevice::append_field(Bytes& out, std::uint64_t value, unsigned bytes) const {
  if (ascii_) return append_hex(out, value, 2 * bytes);
  for (; bytes > 0; --bytes, value >>= 8) out.push_back(static_cast<std::uint8_t>(value));
}

void McDevice::answer(ByteView frame, Instant now, Reaction& reaction) {
  Text text(frame, ascii_);
  const std::uint32_t kind = text.number(1);
  (void)text.number(1);
  const std::uint32_t serial = kind == kFour ? text.number(2) : 0;
  if (kind == kFour) (void)text.number(2);
  const std::uint32_t network = text.number(1), station = text.number(1), module = text.number(2),
                      unit = text.number(1);
  if (station != station_ || network != network_) return;
  (void)text.number(2);  // length
  (void)text.number(2);  // monitoring timer
  const ByteView content = text.rest();
  Result result = run(content, now);
  ++statistics_.responses;
  const auto append_route = [&](Bytes& out) {
    append_field(out, network, 1);
    append_field(out, station, 1);
    append_field(out, module, 2);
    append_field(out, unit, 1);
  };
  if (result.end != 0) {
    ++statistics_.exceptions[result.end];
    result.data.clear();
    append_route(result.data);
    Bytes command(content.begin(), content.end());
    command.resize(ascii_ ? 8 : 4);
    append(result.data, command);
  }
  Bytes& out = reaction.response;
  append_field(out, kind | kResponse, 1);
  append_field(out, 0, 1);
  if (kind == kFour) {
    append_field(out, serial, 2);
    append_field(out, 0, 2);
  }
  append_route(out);
  append_field(out, result.data.size() + (ascii_ ? 4 : 2), 2);
  append_field(out, result.end, 2);
  append(out, result.data);
}

std::optional<McDevice::Place> McDevice::place_at(std::string_view name, ByteView digits) {
  const auto area = area_named(name);
  const auto number = area ? number_in(digits, kAreas[*area].base) : std::nullopt;
  if (!number) return std::nullopt;
  return Place{*area, static_cast<std::uint32_t>(*number)};
}

McDevice::Result McDevice::run(ByteView content, Instant now) {
  Text text(content, ascii_);
  const std::uint32_t command = text.number(2), subcommand = text.number(2);
  Text parameters(text.rest(), ascii_, subcommand >= 2);
  ++statistics_.requests[fmt::format("{:04X}", command)];
  if (text.field_fault() != 0) return {text.field_fault(), {}};
  return execute(command, subcommand, parameters, now);
}

McDevice::Result McDevice::execute(std::uint32_t command, std::uint32_t subcommand, Text& text,
                                   Instant now) {
  if (subcommand > 3) return {kNoCommand, {}};
  const bool bits = subcommand % 2 != 0, series_r = subcommand >= 2;
  switch (command) {
    case 0x0401: return batch(false, bits, text, now);
    case 0x1401: return batch(true, bits, text, now);
    case 0x0403: return bits ? Result{kNoCommand, {}} : random_read(series_r, text, now);
    case 0x0101: return cpu_model();
    case 0x1402: return random_write(bits, series_r, text);
    default: return {kNoCommand, {}};
  }
}

// name of 16 characters, code(2)
McDevice::Result McDevice::cpu_model() const {
  Result result;
  result.data.assign(kMcModel.begin(), kMcModel.end());
  result.data.resize(16, ' ');
  append_field(result.data, kMcCode, 2);
  return result;
}

std::uint16_t McDevice::refusal_of_bits(const Place& place, std::uint32_t bits) const {
  const std::uint32_t items = kAreas[place.area].items;
  if (place.number >= items || bits > items - place.number) return kCpuError | kOutside;
  const std::uint8_t code = memory_.refusal(place.area, place.number, bits, kOutside);
  return code == 0 ? std::uint16_t{0} : static_cast<std::uint16_t>(kCpuError | code);
}

std::uint16_t McDevice::refusal_of_words(const Place& place, std::uint32_t words) const {
  if (kAreas[place.area].bits != 1) return refusal_of_bits(place, words);
  const std::uint32_t items = kAreas[place.area].items;
  if (place.number >= items || words * 16 > items - place.number) return kCpuError | kOutside;
  // A word of bits exists if the PLC has one of them.
  for (std::uint32_t at = place.number; at < place.number + words * 16; at += 16) {
    std::uint8_t code = kOutside;
    for (std::uint32_t bit = 0; bit < 16 && (code == kOutside || code == 0); ++bit) {
      const std::uint8_t own = memory_.refusal(place.area, at + bit, 1, kOutside);
      if (own != kOutside) code = own;
    }
    if (code != 0) return static_cast<std::uint16_t>(kCpuError | code);
  }
  return 0;
}

std::uint16_t McDevice::word(const Place& place, std::uint32_t index, Instant now) const {
  if (kAreas[place.area].bits != 1)
    return static_cast<std::uint16_t>(memory_.read(place.area, place.number + index, now));
  unsigned value = 0;
  for (std::uint32_t bit = 0; bit < 16; ++bit) {
    if (memory_.read(place.area, place.number + index * 16 + bit, now) != 0) value |= 1u << bit;
  }
  return static_cast<std::uint16_t>(value);
}

void McDevice::store_word(const Place& place, std::uint32_t index, std::uint32_t value) {
  if (kAreas[place.area].bits != 1)
    return memory_.write(place.area, place.number + index, value & 0xFFFF, statistics_);
  for (std::uint32_t bit = 0; bit < 16; ++bit)
    memory_.write(place.area, place.number + index * 16 + bit, value >> bit & 1u, statistics_);
}

// device points(2), for a write also the items
McDevice::Result McDevice::batch(bool write, bool bits, Text& text, Instant now) {
  const auto place = text.device();
  const std::uint32_t points = text.number(2);
  if (text.field_fault() != 0) return {text.field_fault(), {}};
  if (!place) return {kNoDevice, {}};
  if (bits && kAreas[place->area].bits != 1) return {kWrongUnits, {}};
  if (points == 0 || points > (!bits ? 960u : ascii_ ? 3584u : 7168u))
    return {bits ? kManyBits : kManyWords, {}};
  const std::uint16_t refused =
      bits ? refusal_of_bits(*place, points) : refusal_of_words(*place, points);
  if (refused != 0) return {refused, {}};
  Result result;
  if (!write) {
    if (text.fault() != 0) return {text.fault(), {}};
    for (std::uint32_t i = 0; i < points; ++i) {
      if (!bits) {
        append_field(result.data, word(*place, i, now), 2);
        continue;
      }
      const unsigned on = memory_.read(place->area, place->number + i, now) != 0 ? 1 : 0;
      if (ascii_)
        append_hex(result.data, on, 1);
      else if (i % 2 == 0)
        result.data.push_back(static_cast<std::uint8_t>(on << 4));
      else
        result.data.back() = static_cast<std::uint8_t>(result.data.back() | on);
    }
    return result;
  }
  std::vector<std::uint32_t> items;
  if (bits) {
    const Bytes states = text.bits(points);
    items.assign(states.begin(), states.end());
    if (std::ranges::any_of(items, [](auto item) { return item > 1; })) return {kBitValue, {}};
  } else {
    for (std::uint32_t i = 0; i < points; ++i) items.push_back(text.number(2));
  }
  if (text.fault() != 0) return {text.fault(), {}};
  for (std::uint32_t i = 0; i < points; ++i) {
    if (bits)
      memory_.write(place->area, place->number + i, items[i], statistics_);
    else
      store_word(*place, i, items[i]);
  }
  ++statistics_.write_requests;
  return result;
}

// words(1) double words(1) device..
McDevice::Result McDevice::random_read(bool series_r, Text& text, Instant now) const {
  const std::uint32_t words = text.number(1), doubles = text.number(1);
  if (words + doubles == 0 || words + doubles > (series_r ? 96u : 192u))
    return {kManyRandomWords, {}};
  Result result;
  for (std::uint32_t i = 0; i < words + doubles; ++i) {
    const auto place = text.device();
    if (text.field_fault() != 0) return {text.field_fault(), {}};
    if (!place) return {kNoDevice, {}};
    const std::uint32_t count = i < words ? 1 : 2;
    if (const std::uint16_t refused = refusal_of_words(*place, count); refused != 0)
      return {refused, {}};
    std::uint32_t value = word(*place, 0, now);
    if (count == 2) value |= static_cast<std::uint32_t>(word(*place, 1, now)) << 16;
    append_field(result.data, value, 2 * count);
  }
  if (text.fault() != 0) return {text.fault(), {}};
  return result;
}

// words(1) double words(1) (device value).., or bits(1) (device state)..
McDevice::Result McDevice::random_write(bool bits, bool series_r, Text& text) {
  struct Item {
    Place place;
    std::uint32_t words, value;
  };
  const std::uint32_t singles = text.number(1), doubles = bits ? 0 : text.number(1);
  if (singles + doubles == 0) return {bits ? kManyRandomBits : kManyRandomWords, {}};
  const std::uint32_t cost = bits ? singles : singles * 12 + doubles * 14;
  if (cost > (bits ? 188u : 1920u) / (series_r ? 2 : 1))
    return {bits ? kManyRandomBits : kManyRandomWords, {}};
  std::vector<Item> items;
  for (std::uint32_t i = 0; i < singles + doubles; ++i) {
    const auto place = text.device();
    const std::uint32_t words = i < singles ? 1 : 2;
    const std::uint32_t value = text.number(bits && !series_r ? 1 : 2 * words);
    if (text.field_fault() != 0) return {text.field_fault(), {}};
    if (!place) return {kNoDevice, {}};
    if (bits && kAreas[place->area].bits != 1) return {kWrongUnits, {}};
    if (bits && value > 1) return {kBitValue, {}};
    const std::uint16_t refused =
        bits ? refusal_of_bits(*place, 1) : refusal_of_words(*place, words);
    if (refused != 0) return {refused, {}};
    items.push_back({*place, words, value});
  }
  if (text.fault() != 0) return {text.fault(), {}};
  for (const Item& item : items) {
    if (bits) {
      memory_.write(item.place.area, item.place.number, item.value, statistics_);
      continue;
    }
    for (std::uint32_t i = 0; i < item.words; ++i) store_word(item.place, i, item.value >> 16 * i);
  }
  ++statistics_.write_requests;
  return {};
}

tl::expected<std::unique_ptr<SimDevice>, std::string> make_mc_device(const DeviceSetup& setup) {
  return make_memory_device<McDevice>(setup, 255, parse_mc_address, "station");
}

}  // namespace fieldcast::sim
