#include "core/bus/command/device_probe.hpp"

#include <algorithm>
#include <array>
#include <span>

namespace fieldcast {
namespace {

// Causes that concern the bus: they would end every other request, too.
constexpr std::array kOfBus{Cause::kExpired, Cause::kShutdown, Cause::kLeased, Cause::kPortClosed,
                            Cause::kOffline};
constexpr std::array kOfResponse{Cause::kNone, Cause::kDeviceError, Cause::kDeviceBusy,
                                 Cause::kNotAvailable};

bool is_one_of(std::span<const Cause> causes, Cause cause) {
  return std::ranges::find(causes, cause) != causes.end();
}

}  // namespace

DeviceProbe::DeviceProbe(std::vector<DeviceSpec> devices, Instant expires, std::size_t questions)
    : expires_(expires), questions_(questions) {
  devices.resize(std::min(devices.size(), kMostDevices));
  for (DeviceSpec& device : devices) {
    if (device.channels.size() > kMostChannels) device.channels.resize(kMostChannels);
    if (!device.channels.empty())
      specs_.push_back(std::make_shared<const DeviceSpec>(std::move(device)));
  }
  if (!specs_.empty()) probed_.push_back({specs_.front()->name, {}});
}

std::optional<Command> DeviceProbe::next() const {
  if (ended_ || probed_.empty()) return std::nullopt;
  const auto& spec = specs_[probed_.size() - 1];
  Command command;
  command.requester = "first values";
  command.request_id = requests_ + 1;
  command.device = spec->name;
  command.target = ChannelTarget{spec->channels[channel_].name};
  command.operation = Operation::kAcquire;
  command.expires = expires_;
  command.ad_hoc = spec;
  return command;
}

void DeviceProbe::on_result(const CommandResult& result) {
  ++requests_;
  ProbedDevice& device = probed_.back();
  const DeviceSpec& spec = *specs_[probed_.size() - 1];
  ProbedChannel channel;
  channel.name = spec.channels[channel_].name;
  if (!result.values.empty()) channel.value = result.values.front();
  channel.cause = result.cause;
  channel.reason = result.reason;
  // A range fault of a request that was sent is that of the received items.
  channel.responded = is_one_of(kOfResponse, result.cause) ||
                      (result.cause == Cause::kRange && result.state == CommandState::kFailed);
  channel.at = result.completed;
  channel.took = result.completed - result.started;
  device.channels.push_back(std::move(channel));
  ended_ = ends_probe(result.cause);
  if (ended_) return;
  const auto following = channel_after(device);
  channel_ = following.value_or(0);
  if (following) return;
  if (probed_.size() == specs_.size())
    ended_ = true;
  else
    probed_.push_back({specs_[probed_.size()]->name, {}});
}

bool DeviceProbe::ends_probe(Cause cause) { return is_one_of(kOfBus, cause); }

std::optional<std::size_t> DeviceProbe::channel_after(const ProbedDevice& device) const {
  const bool responds = std::ranges::any_of(device.channels, &ProbedChannel::responded);
  const bool is_silent =
      std::ranges::count(device.channels, Cause::kNoResponse, &ProbedChannel::cause) >=
      static_cast<std::ptrdiff_t>(kMostSilent);
  const bool is_question = channel_ < questions_;
  std::size_t following = channel_ + 1;
  if (is_question && responds) following = questions_;
  const bool ends = responds ? questions_ > 0 && !is_question && !device.channels.back().value
                             : is_silent || following == questions_;
  if (ends || following >= specs_[probed_.size() - 1]->channels.size()) return std::nullopt;
  return following;
}

}  // namespace fieldcast
