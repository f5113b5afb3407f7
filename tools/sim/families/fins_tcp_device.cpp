#include "tools/sim/families/fins_tcp_device.hpp"

#include <algorithm>
#include <string_view>

namespace fieldcast::sim {
namespace {

constexpr std::string_view kStart = "FINS";
constexpr std::size_t kToLength = 8, kToData = 16;
constexpr std::uint32_t kNodeOfClient = 0, kNodesOfBoth = 1, kFinsMessage = 2;
constexpr std::uint32_t kNotFins = 1, kLengthError = 2, kNoSuchCommand = 3,
                        kConnectedAlready = 0x21;
constexpr std::size_t kNodeOffset = 4;   // of DA1 in a message
constexpr std::size_t kMostItems = 167;  // of command 0104
constexpr std::uint8_t kClientNode = 239, kOwnNode = 10;

Bytes tcp_frame(std::uint32_t command, std::uint32_t error, ByteView data) {
  Bytes frame(kStart.begin(), kStart.end());
  append_u32(frame, static_cast<std::uint32_t>(8 + data.size()));
  append_u32(frame, command);
  append_u32(frame, error);
  append(frame, data);
  return frame;
}

}  // namespace

class FinsTcpDevice::Connection : public Receiver {
 public:
  explicit Connection(FinsTcpDevice& device) : device_(device) {}

  void on_character(std::uint8_t character, Instant end, Reaction& reaction) override {
    received_.push_back(character);
    if (received_.size() <= kStart.size() &&
        character != static_cast<std::uint8_t>(kStart[received_.size() - 1]))
      return refuse(kNotFins, reaction);
    if (received_.size() < kToLength) return;
    const std::size_t length = read_u32(received_, kStart.size());
    if (length < 8 || length > 8 + kMostMessage) return refuse(kLengthError, reaction);
    if (received_.size() < kToLength + length) return;
    const Bytes frame = std::exchange(received_, {});
    execute(read_u32(frame, kToLength), ByteView(frame).subspan(kToData), end, reaction);
  }

 private:
  void execute(std::uint32_t command, ByteView data, Instant now, Reaction& reaction) {
    if (command == kNodeOfClient) {
      if (data.size() != 4) return refuse(kLengthError, reaction);
      if (greeted_) {
        if (device_.has_port_) reaction.response = tcp_frame(kNodesOfBoth, kConnectedAlready, {});
        return;
      }
      greeted_ = true;
      if (!device_.has_port_) return;
      const std::uint32_t wanted = read_u32(data);
      Bytes nodes;
      append_u32(nodes, wanted == 0 ? kClientNode : wanted);
      append_u32(nodes, device_.node_);
      reaction.response = tcp_frame(kNodesOfBoth, 0, nodes);
      return;
    }
    if (command != kFinsMessage || !greeted_) return refuse(kNoSuchCommand, reaction);
    if (data.size() <= kNodeOffset || data[kNodeOffset] != device_.node_) return;
    const Bytes response = device_.fins_.execute(data, now);
    if (response.empty()) {
      ++device_.statistics_.bad_frames;
      return;
    }
    ++device_.statistics_.responses;
    reaction.response = tcp_frame(kFinsMessage, 0, response);
  }

  void refuse(std::uint32_t error, Reaction& reaction) {
    received_.clear();
    if (!device_.has_port_) return;
    ++device_.statistics_.bad_frames;
    reaction.response = tcp_frame(kNodesOfBoth, error, {});
    reaction.hang_up = true;
  }

  FinsTcpDevice& device_;
  Bytes received_;
  bool greeted_ = false;
};

// The characters of a datagram follow each other without a gap.
class FinsTcpDevice::Datagrams : public GapReceiver {
 public:
  explicit Datagrams(FinsTcpDevice& device)
      : GapReceiver(device.line_, device.line_.characters(1)), device_(device) {}

  void on_character(std::uint8_t character, Instant end, Reaction& reaction) override {
    heard(end, reaction);
    if (received_.size() <= kMostMessage) received_.push_back(character);
  }
  void on_silence(Instant now, Reaction& reaction) override {
    const Bytes message = received_;
    ready(false);
    if (message.size() <= kNodeOffset || message[kNodeOffset] != device_.node_) return;
    reaction.response = device_.fins_.execute(message, now);
    ++(reaction.response.empty() ? device_.statistics_.bad_frames : device_.statistics_.responses);
  }

 private:
  FinsTcpDevice& device_;
};

FinsTcpDevice::FinsTcpDevice(const DeviceSetup& setup)
    : MemoryDevice({omron_areas(), setup}),
      node_(setup.spec.link.address == 0 ? kOwnNode
                                         : static_cast<std::uint8_t>(setup.spec.link.address)),
      has_port_(setup.first_on_bus),
      datagrams_(setup.spec.link.options.contains("client-node")),
      line_(setup.line),
      fins_(memory_, statistics_, {kMostMessage, kMostItems}) {}

std::unique_ptr<Receiver> FinsTcpDevice::open_receiver() {
  if (datagrams_) return std::make_unique<Datagrams>(*this);
  return std::make_unique<Connection>(*this);
}

tl::expected<std::unique_ptr<SimDevice>, std::string> make_fins_tcp_device(
    const DeviceSetup& setup) {
  return make_memory_device<FinsTcpDevice>(setup, 254, parse_omron_address, "node");
}

}  // namespace fieldcast::sim
