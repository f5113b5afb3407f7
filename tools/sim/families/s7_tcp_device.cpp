#include "tools/sim/families/s7_tcp_device.hpp"

#include <algorithm>
#include <string>

namespace fieldcast::sim {
namespace {

constexpr std::uint8_t kConnect = 0xE0, kConfirm = 0xD0, kDataTpdu = 0xF0, kDisconnect = 0x80;
constexpr std::uint8_t kLastPart = 0x80, kCalledTsap = 0xC2;
constexpr std::size_t kTpkt = 4, kConnectHead = 7, kMostFrame = 1031;
constexpr std::uint16_t kMostMessage = 960;

Bytes tpkt_of(ByteView tpdu) {
  Bytes frame{3, 0};
  append_u16(frame, static_cast<std::uint16_t>(kTpkt + tpdu.size()));
  append(frame, tpdu);
  return frame;
}

// LI type destination(2) source(2) class, then parameters: code length value
std::optional<std::uint16_t> called_tsap(ByteView tpdu) {
  for (std::size_t at = kConnectHead; at + 2 <= tpdu.size(); at += 2 + tpdu[at + 1]) {
    if (at + 2 + tpdu[at + 1] > tpdu.size()) return std::nullopt;
    if (tpdu[at] == kCalledTsap && tpdu[at + 1] == 2) return read_u16(tpdu, at + 2);
  }
  return std::nullopt;
}

}  // namespace

class S7TcpDevice::Connection : public Receiver {
 public:
  explicit Connection(S7TcpDevice& device) : device_(device) {}

  void on_character(std::uint8_t character, Instant end, Reaction& reaction) override {
    received_.push_back(character);
    if (received_[0] != 3) return end_connection(reaction);
    if (received_.size() < kTpkt) return;
    const std::size_t size = read_u16(received_, 2);
    if (size < kTpkt + 3 || size > kMostFrame) return end_connection(reaction);
    if (received_.size() < size) return;
    const Bytes frame = std::exchange(received_, {});
    answer(ByteView(frame).subspan(kTpkt), end, reaction);
  }

 private:
  void answer(ByteView tpdu, Instant now, Reaction& reaction) {
    if (tpdu[0] + std::size_t{1} > tpdu.size()) return end_connection(reaction);
    if (tpdu[1] == kConnect && !connected_ && tpdu.size() >= kConnectHead)
      return connect(tpdu, reaction);
    const std::size_t header = tpdu[0] + std::size_t{1};
    if (tpdu[1] != kDataTpdu || !connected_ || header != 3 || tpdu[2] != kLastPart)
      return end_connection(reaction);
    const Bytes response = device_.unit_.execute(tpdu.subspan(header), now);
    if (response.empty()) {
      ++device_.statistics_.bad_frames;
      return;
    }
    Bytes data{2, kDataTpdu, kLastPart};
    append(data, response);
    reaction.response = tpkt_of(data);
  }

  void connect(ByteView tpdu, Reaction& reaction) {
    const auto tsap = called_tsap(tpdu);
    // The high byte of a place is the kind of the connection.
    const std::uint16_t compared = device_.named_ ? 0xFFFF : 0x00FF;
    connected_ = tsap && (*tsap & compared) == (device_.tsap_ & compared);
    if (!connected_) {
      reaction.response =
          tpkt_of(Bytes{6, kDisconnect, tpdu[4], tpdu[5], 0, 0, 3});  // address unknown
      reaction.hang_up = true;
      return;
    }
    Bytes confirm{static_cast<std::uint8_t>(tpdu.size() - 1), kConfirm, tpdu[4], tpdu[5], 0, 6, 0};
    append(confirm, tpdu.subspan(kConnectHead));
    reaction.response = tpkt_of(confirm);
  }

  void end_connection(Reaction& reaction) {
    received_.clear();
    ++device_.statistics_.bad_frames;
    reaction.hang_up = true;
  }

  S7TcpDevice& device_;
  Bytes received_;
  bool connected_ = false;
};

S7TcpDevice::S7TcpDevice(const DeviceSetup& setup, std::span<const S7Area> areas,
                         std::uint16_t tsap, bool named)
    : MemoryDevice({s7_areas(areas), setup}),
      tsap_(tsap),
      named_(named),
      unit_(memory_, statistics_, areas, kMostMessage) {}

std::unique_ptr<Receiver> S7TcpDevice::open_receiver() {
  return std::make_unique<Connection>(*this);
}

tl::expected<std::unique_ptr<SimDevice>, std::string> make_s7_tcp_device(const DeviceSetup& setup) {
  const auto& options = setup.spec.link.options;
  const auto option = [&](const char* name) {
    const auto found = options.find(name);
    return found == options.end() ? std::string() : found->second;
  };
  const std::span<const S7Area> areas = option("cpu") == "s7-200"
                                            ? std::span<const S7Area>(kS7SmartAreas)
                                            : std::span<const S7Area>(kS71500Areas);
  const std::string tsap = option("tsap"), rack = option("rack");
  const auto place = static_cast<std::uint16_t>((rack.empty() ? 0 : std::stoul(rack)) << 5 |
                                                setup.spec.link.address);
  const auto called =
      tsap.size() != 5
          ? place
          : static_cast<std::uint16_t>(std::stoul(tsap.substr(0, 2), nullptr, 16) << 8 |
                                       std::stoul(tsap.substr(3), nullptr, 16));
  if (setup.spec.link.address > 31)
    return tl::unexpected(setup.spec.name + ": slot " + std::to_string(setup.spec.link.address) +
                          " is not 0..31");
  auto device = std::make_unique<S7TcpDevice>(setup, areas, called, !tsap.empty());
  const auto parse = [areas](std::string_view at) { return parse_s7_address(areas, at); };
  if (auto added = device->memory().add_channels(setup, parse); !added)
    return tl::unexpected(added.error());
  return device;
}

}  // namespace fieldcast::sim
