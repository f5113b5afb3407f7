#include "tools/sim/families/ppi_device.hpp"

#include "core/codec/checksum.hpp"

namespace fieldcast::sim {
namespace {

constexpr std::uint8_t kLong = 0x68, kShort = 0x10, kToken = 0xDC, kAcknowledge = 0xE5, kEnd = 0x16;
constexpr std::uint8_t kRequest = 0x40, kNoData = 0x09, kData = 0x08;
constexpr std::size_t kLeastCounted = 3, kMostCounted = 249, kShortSize = 6, kTokenSize = 3;

// Telegrams are recognized by their length, because data can contain any start byte. Drops invalid
// bytes up to the next possible start, and all bytes after a silence.
class PpiReceiver : public GapReceiver {
 public:
  PpiReceiver(PpiDevice& device, const LineFormat& line, bool stream)
      : GapReceiver(line, stream ? kStreamGap : line.characters(3.5)), device_(device) {}

  void on_character(std::uint8_t character, Instant end, Reaction& reaction) override {
    heard(end, reaction);
    received_.push_back(character);
    for (std::size_t size = 1; size != 0 && !received_.empty();) {
      size = whole(end, reaction);
      received_.erase(received_.begin(), received_.begin() + static_cast<std::ptrdiff_t>(size));
    }
  }

 private:
  // Returns the number of consumed bytes, or 0 if the telegram is incomplete.
  std::size_t whole(Instant end, Reaction& reaction) {
    switch (received_[0]) {
      case kLong: return whole_long(end, reaction);
      case kShort:
        if (received_.size() < kShortSize) return 0;
        if (received_[4] != sum8(ByteView(received_).subspan(1, 3)) || received_[5] != kEnd)
          return 1;
        reaction.response = device_.take_short(received_[1], received_[2], received_[3]);
        return kShortSize;
      case kToken: return received_.size() < kTokenSize ? 0 : kTokenSize;
      default: return 1;
    }
  }
  std::size_t whole_long(Instant end, Reaction& reaction) {
    if (received_.size() < 4) return 0;
    const std::size_t counted = received_[1];
    if (received_[2] != counted || received_[3] != kLong || counted < kLeastCounted ||
        counted > kMostCounted)
      return 1;
    if (received_.size() < counted + 6) return 0;
    const ByteView telegram = ByteView(received_).subspan(4, counted);
    if (sum8(telegram) != received_[4 + counted] || received_[5 + counted] != kEnd) return 1;
    reaction.response = device_.take_long(telegram, end);
    return counted + 6;
  }

  PpiDevice& device_;
};

Bytes long_telegram(std::uint8_t to, std::uint8_t from, ByteView unit) {
  Bytes counted{to, from, kData};
  append(counted, unit);
  const auto length = static_cast<std::uint8_t>(counted.size());
  Bytes telegram{kLong, length, length, kLong};
  append(telegram, counted);
  telegram.push_back(sum8(counted));
  telegram.push_back(kEnd);
  return telegram;
}

Bytes short_telegram(std::uint8_t to, std::uint8_t from, std::uint8_t control) {
  const Bytes counted{to, from, control};
  return {kShort, to, from, control, sum8(counted), kEnd};
}

}  // namespace

PpiDevice::PpiDevice(const DeviceSetup& setup)
    : MemoryDevice({s7_areas(kPpiAreas), setup}),
      station_(static_cast<std::uint8_t>(setup.spec.link.address)),
      line_(setup.line),
      stream_(setup.stream),
      unit_(memory_, statistics_, kPpiAreas, 240) {}

std::unique_ptr<Receiver> PpiDevice::open_receiver() {
  return std::make_unique<PpiReceiver>(*this, line_, stream_);
}

Bytes PpiDevice::take_long(ByteView telegram, Instant now) {
  const std::uint8_t control = telegram[2];
  const bool sends_data = (control & 0x0Fu) == 0x0C || (control & 0x0Fu) == 0x0D;
  if (telegram[0] != station_ || (control & kRequest) == 0 || !sends_data) return {};
  const Bytes response = unit_.execute(telegram.subspan(3), now);
  if (response.empty()) return {};
  queued_ = long_telegram(telegram[1], station_, response);
  last_poll_.reset();
  return {kAcknowledge};
}

Bytes PpiDevice::take_short(std::uint8_t to, std::uint8_t from, std::uint8_t control) {
  if (to != station_ || (control & kRequest) == 0) return {};
  // FDL status request: the station is present.
  if ((control & 0x0Fu) == 0x09) return short_telegram(from, station_, 0x00);
  if ((control & 0x0Fu) != 0x0C && (control & 0x0Fu) != 0x0D) return {};
  if (queued_.empty()) {
    if (last_poll_ == control) return given_;
    return short_telegram(from, station_, kNoData);
  }
  last_poll_ = control;
  given_ = std::move(queued_);
  queued_.clear();
  return given_;
}

tl::expected<std::unique_ptr<SimDevice>, std::string> make_ppi_device(const DeviceSetup& setup) {
  return make_memory_device<PpiDevice>(
      setup, 126, [](std::string_view at) { return parse_s7_address(kPpiAreas, at); });
}

}  // namespace fieldcast::sim
