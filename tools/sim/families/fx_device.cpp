#include "tools/sim/families/fx_device.hpp"

#include <algorithm>

#include "core/codec/checksum.hpp"
#include "tools/sim/device/device.hpp"

namespace fieldcast::sim {
namespace {

constexpr std::uint8_t kStx = 0x02, kEtx = 0x03, kEnq = 0x05, kAck = 0x06, kNak = 0x15;
constexpr std::size_t kMostReceived = 300, kMostBytes = 64;

enum Area : std::size_t {
  kD,
  kD8000,
  kT,
  kC,
  kC200,
  kM,
  kM8000,
  kX,
  kY,
  kS,
  kTs,
  kTc,
  kCs,
  kCc,
  kAreas
};

// Start of an area in an address map, and its number of items there.
struct Segment {
  Area area;
  std::uint32_t base, items;
};
constexpr Segment kClassic[] = {{kS, 0x0000, 1000},    {kX, 0x0080, 256},  {kY, 0x00A0, 256},
                                {kTs, 0x00C0, 256},    {kM, 0x0100, 1536}, {kCs, 0x01C0, 256},
                                {kM8000, 0x01E0, 256}, {kTc, 0x02C0, 256}, {kCc, 0x03C0, 256},
                                {kT, 0x0800, 256},     {kC, 0x0A00, 200},  {kC200, 0x0C00, 56},
                                {kD8000, 0x0E00, 256}, {kD, 0x1000, 8000}};
constexpr Segment kExtended[] = {{kC, 0x0A00, 200},     {kT, 0x1000, 320},  {kD, 0x4000, 8000},
                                 {kD8000, 0x8000, 512}, {kM, 0x8800, 7680}, {kY, 0x8BC0, 256},
                                 {kM8000, 0x8C00, 512}, {kX, 0x8CA0, 256},  {kS, 0x8CE0, 4096}};
// Each forced bit has its own address.
constexpr Segment kClassicForce[] = {{kS, 0x0000, 1000},   {kX, 0x0400, 256},  {kY, 0x0500, 256},
                                     {kTs, 0x0600, 256},   {kM, 0x0800, 1536}, {kCs, 0x0E00, 256},
                                     {kM8000, 0x0F00, 256}};
constexpr Segment kExtendedForce[] = {
    {kM, 0x4000, 7680}, {kY, 0x5E00, 256}, {kM8000, 0x6000, 512}, {kS, 0x6700, 4096}};

constexpr unsigned kBits[kAreas] = {16, 16, 16, 16, 32, 1, 1, 1, 1, 1, 1, 1, 1, 1};
constexpr std::uint32_t kItems[kAreas] = {8000, 512, 320,  200, 56,  7680, 512,
                                          256,  256, 4096, 256, 256, 256,  256};

std::vector<ItemArea> fx_areas() {
  std::vector<ItemArea> areas;
  for (std::size_t area = 0; area < kAreas; ++area)
    areas.push_back({kFxAreaNames[area], kBits[area], kItems[area]});
  return areas;
}

// Within a frame only STX starts a new one. An ENQ is data: a flipped bit changes `E` to ENQ.
class FxReceiver : public Receiver {
 public:
  explicit FxReceiver(FxDevice& device) : device_(device) {}
  void on_character(std::uint8_t character, Instant end, Reaction& reaction) override {
    if (character == kStx) {
      inside_ = true;
      sum_at_ = 0;
      text_.clear();
    } else if (!inside_) {
      if (character == kEnq) reaction.response = {kAck};
    } else {
      text_.push_back(character);
      if (sum_at_ == 0 && character == kEtx) sum_at_ = text_.size();
      if (sum_at_ != 0 && text_.size() == sum_at_ + 2) {
        reaction.response =
            device_.take(ByteView(text_).first(sum_at_), ByteView(text_).last(2), end);
        inside_ = false;
      }
      if (text_.size() == kMostReceived) inside_ = false;
    }
  }

 private:
  FxDevice& device_;
  bool inside_ = false;
  Bytes text_;
  std::size_t sum_at_ = 0;
};

std::optional<ItemAddress> parse_fx_address(std::string_view at) {
  const std::size_t digits = std::min(at.find_first_of("0123456789"), at.size());
  std::string_view name = at.substr(0, digits);
  if (name == "TN" || name == "CN") name = name.substr(0, 1);
  const std::size_t dot = at.find('.');
  const auto number =
      address_number(at.substr(digits, dot == std::string_view::npos ? dot : dot - digits),
                     name == "X" || name == "Y" ? 8 : 10);
  const auto found = std::ranges::find(kFxAreaNames, name);
  if (!number || found == kFxAreaNames.end()) return std::nullopt;
  ItemAddress address{.area = static_cast<std::size_t>(found - kFxAreaNames.begin()),
                      .first = static_cast<std::uint32_t>(*number)};
  const auto upper = [&](Area from, Area to, std::uint32_t first) {
    if (address.area == from && *number >= first) address.area = to, address.first -= first;
  };
  upper(kD, kD8000, 8000);
  upper(kM, kM8000, 8000);
  upper(kC, kC200, 200);
  if (dot == std::string_view::npos) return address;
  const auto bit = address_number(at.substr(dot + 1));
  if (!bit || *bit >= kBits[address.area]) return std::nullopt;
  address.bit = static_cast<std::uint8_t>(*bit);
  return address;
}

}  // namespace

FxDevice::FxDevice(const DeviceSetup& setup) : MemoryDevice({fx_areas(), setup}) {}

std::unique_ptr<Receiver> FxDevice::open_receiver() { return std::make_unique<FxReceiver>(*this); }

Bytes FxDevice::take(ByteView text, ByteView sum, Instant now) {
  ++statistics_.responses;
  if (number_in(sum) != sum8(text)) {
    ++statistics_.bad_frames;
    return {kNak};
  }
  Bytes response = execute(text.first(text.size() - 1), now);
  if (response == Bytes{kNak}) ++statistics_.exceptions[kNak];
  return response;
}

Bytes FxDevice::execute(ByteView text, Instant now) {
  const bool extended = !text.empty() && text[0] == 'E';
  const std::string name(text.begin(),
                         text.begin() + static_cast<std::ptrdiff_t>(
                                            std::min<std::size_t>(text.size(), extended ? 3 : 1)));
  ++statistics_.requests[extended && name[1] != '0' && name[1] != '1' ? name.substr(0, 2) : name];
  if (name == "0" || name == "E00") return read(extended, text.subspan(name.size()), now);
  if (name == "1" || name == "E10") return write(extended, text.subspan(name.size()), now);
  const std::size_t command = extended ? 1 : 0;
  if (text.size() > command && (text[command] == '7' || text[command] == '8')) {
    return force(extended, text.subspan(command + 1), text[command] == '7');
  }
  return {kNak};
}

std::optional<FxDevice::Cell> FxDevice::cell_at(bool extended, std::uint32_t address) const {
  for (const Segment& segment :
       extended ? std::span<const Segment>(kExtended) : std::span<const Segment>(kClassic)) {
    const std::uint32_t bits = kBits[segment.area];
    if (address < segment.base || (address - segment.base) * 8 >= segment.items * bits) continue;
    const std::uint32_t offset = address - segment.base;
    if (bits == 1) return Cell{segment.area, offset * 8, 0};
    return Cell{segment.area, offset / (bits / 8), offset % (bits / 8)};
  }
  return std::nullopt;
}

bool FxDevice::refuses(const Cell& cell) const {
  const std::uint32_t left = kItems[cell.area] - cell.item;
  return memory_.refusal(cell.area, cell.item, kBits[cell.area] == 1 ? std::min(8u, left) : 1,
                         kNak) != 0;
}

std::uint8_t FxDevice::load(const Cell& cell, Instant now) const {
  if (kBits[cell.area] != 1)
    return static_cast<std::uint8_t>(memory_.read(cell.area, cell.item, now) >> 8 * cell.byte);
  unsigned byte = 0;
  for (unsigned bit = 0; bit < std::min(8u, kItems[cell.area] - cell.item); ++bit) {
    byte |= (memory_.read(cell.area, cell.item + bit, now) != 0 ? 1u : 0u) << bit;
  }
  return static_cast<std::uint8_t>(byte);
}

void FxDevice::store(const Cell& cell, std::uint8_t byte, Instant now) {
  if (kBits[cell.area] == 1) {
    for (unsigned bit = 0; bit < std::min(8u, kItems[cell.area] - cell.item); ++bit) {
      memory_.write(cell.area, cell.item + bit, byte >> bit & 1u, statistics_);
    }
    return;
  }
  const std::uint64_t mask = std::uint64_t{0xFF} << 8 * cell.byte;
  const std::uint64_t item =
      (memory_.read(cell.area, cell.item, now) & ~mask) | std::uint64_t{byte} << 8 * cell.byte;
  const bool whole = cell.byte + 1 == kBits[cell.area] / 8;  // counted once for each item
  whole ? memory_.write(cell.area, cell.item, item, statistics_)
        : memory_.write(cell.area, cell.item, item);
}

// address(4) count(2) -> 02 data 03 sum
Bytes FxDevice::read(bool extended, ByteView range, Instant now) const {
  const auto address = range.size() == 6 ? number_in(range.first(4)) : std::nullopt;
  const auto count = range.size() == 6 ? number_in(range.subspan(4)) : std::nullopt;
  if (!address || !count || *count < 1 || *count > kMostBytes) return {kNak};
  Bytes text;
  for (std::uint32_t i = 0; i < *count; ++i) {
    const auto cell = cell_at(extended, static_cast<std::uint32_t>(*address) + i);
    if (!cell || refuses(*cell)) return {kNak};
    append_hex(text, load(*cell, now), 2);
  }
  text.push_back(kEtx);
  Bytes response{kStx};
  append(response, text);
  append_hex(response, sum8(text), 2);
  return response;
}

// address(4) count(2) data -> 06
Bytes FxDevice::write(bool extended, ByteView range, Instant now) {
  const auto address = range.size() >= 6 ? number_in(range.first(4)) : std::nullopt;
  const auto count = range.size() >= 6 ? number_in(range.subspan(4, 2)) : std::nullopt;
  const auto data = range.size() >= 6 ? bytes_in(range.subspan(6)) : std::nullopt;
  if (!address || !count || !data || *count < 1 || *count > kMostBytes || data->size() != *count)
    return {kNak};
  std::vector<Cell> cells;
  for (std::uint32_t i = 0; i < *count; ++i) {
    const auto cell = cell_at(extended, static_cast<std::uint32_t>(*address) + i);
    if (!cell || refuses(*cell)) return {kNak};
    cells.push_back(*cell);
  }
  for (std::size_t i = 0; i < cells.size(); ++i) store(cells[i], (*data)[i], now);
  ++statistics_.write_requests;
  return {kAck};
}

// address(4), low pair of digits first -> 06
Bytes FxDevice::force(bool extended, ByteView range, bool on) {
  const auto turned = range.size() == 4 ? number_in(range) : std::nullopt;
  if (!turned) return {kNak};
  const auto address = static_cast<std::uint32_t>((*turned & 0xFF) << 8 | *turned >> 8);
  for (const Segment& segment : extended ? std::span<const Segment>(kExtendedForce)
                                         : std::span<const Segment>(kClassicForce)) {
    if (address < segment.base || address - segment.base >= segment.items) continue;
    const std::uint32_t item = address - segment.base;
    if (memory_.refusal(segment.area, item, 1, kNak) != 0) return {kNak};
    memory_.write(segment.area, item, on ? 1 : 0, statistics_);
    ++statistics_.write_requests;
    return {kAck};
  }
  return {kNak};
}

tl::expected<std::unique_ptr<SimDevice>, std::string> make_fx_device(const DeviceSetup& setup) {
  return make_memory_device<FxDevice>(setup, UINT16_MAX, parse_fx_address);
}

}  // namespace fieldcast::sim
