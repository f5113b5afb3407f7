#include "tools/sim/families/freeport_device.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "core/codec/checksum.hpp"
#include "tools/sim/device/device.hpp"

namespace fieldcast::sim {
namespace {

constexpr std::size_t kRequest = 17, kResponse = 12, kRefusal = 7, kMostReceived = 64;
enum Code : std::uint8_t { kCheck = 1, kLength, kDigits, kCommand };

// Data never contains `q`, so it starts a frame at any position.
class FreeportReceiver : public Receiver {
 public:
  explicit FreeportReceiver(FreeportDevice& device) : device_(device) {}
  void on_character(std::uint8_t character, Instant end, Reaction& reaction) override {
    if (character == 'q') frame_.clear();
    if (frame_.empty() && character != 'q') return;
    if (frame_.size() == kMostReceived) return;  // babble; the next `q` ends it
    frame_.push_back(character);
    if (character != 'Q') return;
    reaction.response = device_.take(frame_, end);
    frame_.clear();
  }

 private:
  FreeportDevice& device_;
  Bytes frame_;
};

Bytes framed(const Bytes& text) {
  Bytes frame;
  frame.reserve(text.size() + 4);
  frame.push_back('q');
  append(frame, text);
  append_hex(frame, xor8(text), 2);
  frame.push_back('Q');
  return frame;
}

std::optional<ItemAddress> parse_window(std::string_view at) {
  if (!at.starts_with("window:")) return std::nullopt;
  at.remove_prefix(7);
  const std::size_t dot = at.find('.');
  const auto byte = address_number(at.substr(0, dot));
  if (!byte || *byte > 3) return std::nullopt;
  ItemAddress address{.first = static_cast<std::uint32_t>(*byte)};
  if (dot == std::string_view::npos) return address;
  const auto bit = address_number(at.substr(dot + 1));
  if (!bit || *bit > 7) return std::nullopt;
  address.bit = static_cast<std::uint8_t>(*bit);
  return address;
}

// The whole window exists, even if channels use only parts of it.
DeviceSetup whole_window(DeviceSetup setup) {
  setup.only_configured = false;
  return setup;
}

bool letters_swapped(const DeviceSetup& setup) {
  const auto found = setup.spec.link.options.find("letters");
  return found != setup.spec.link.options.end() && found->second == "swapped";
}

}  // namespace

FreeportDevice::FreeportDevice(const DeviceSetup& setup)
    : MemoryDevice(ItemMemory({{kFreeportAreaNames[0], 8, kBytes}}, whole_window(setup))),
      station_(static_cast<std::uint8_t>(setup.spec.link.address)),
      read_(letters_swapped(setup) ? 'R' : 'W'),
      write_(letters_swapped(setup) ? 'W' : 'R') {
  mirrored_.fill(true);
  for (const ChannelSpec& channel : setup.spec.channels) {
    const auto at = parse_window(channel.at);
    if (!at || channel.access != Access::kReadOnly) continue;
    const std::uint32_t bytes = (waveform_bits(channel.encoding) + 7) / 8;
    for (std::uint32_t i = at->first; i < std::min(at->first + bytes, kBytes); ++i)
      mirrored_[i] = false;
  }
}

std::unique_ptr<Receiver> FreeportDevice::open_receiver() {
  return std::make_unique<FreeportReceiver>(*this);
}

Bytes FreeportDevice::take(ByteView frame, Instant now) {
  if (frame.size() == kResponse || frame.size() == kRefusal || frame.size() < 5) return {};
  if (number_in(frame.subspan(2, 2)) != station_) return {};
  const auto length = number_in(frame.subspan(4, 2));
  if (frame.size() != kRequest || (length && (*length < 1 || *length > kBytes)))
    return refuse(kLength);
  const auto data = bytes_in(frame.subspan(6, 8));
  const auto check = number_in(frame.subspan(14, 2));
  if (!length || !data || !check) return refuse(kDigits);
  if (*check != xor8(frame.subspan(1, 13))) return refuse(kCheck);
  const char command = static_cast<char>(frame[1]);
  if (command != read_ && command != write_) return refuse(kCommand);
  const auto bytes = static_cast<std::uint32_t>(*length);
  ++statistics_.requests[command == read_ ? "read" : "write"];
  if (const std::uint8_t code = memory_.refusal(0, 0, bytes, kLength); code != 0)
    return refuse(code);
  ++statistics_.responses;
  return command == read_ ? show(bytes, now) : store(*data, bytes);
}

Bytes FreeportDevice::refuse(std::uint8_t code) {
  ++statistics_.responses;
  ++statistics_.exceptions[code];
  Bytes text{'E'};
  append_hex(text, code, 2);
  return framed(text);
}

Bytes FreeportDevice::show(std::uint32_t length, Instant now) const {
  Bytes text;
  for (std::uint32_t i = 0; i < kBytes; ++i)
    append_hex(text, i < length ? memory_.read(0, i, now) : 0, 2);
  return framed(text);
}

Bytes FreeportDevice::store(ByteView data, std::uint32_t length) {
  ++statistics_.write_requests;
  Bytes text;
  for (std::uint32_t i = 0; i < kBytes; ++i) {
    if (i < length) {
      written_[i] = data[i];
      ++statistics_.writes[fmt::format("window:{}", i)];
      if (mirrored_[i]) memory_.write(0, i, data[i]);
    }
    append_hex(text, written_[i], 2);
  }
  return framed(text);
}

tl::expected<std::unique_ptr<SimDevice>, std::string> make_freeport_device(
    const DeviceSetup& setup) {
  return make_memory_device<FreeportDevice>(setup, 255, parse_window);
}

}  // namespace fieldcast::sim
