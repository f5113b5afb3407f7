// Reads first values of devices that are not configured, one channel after the other: next() is the
// next command, on_result() its result. The bus sends these commands in spare time (Arbiter). Pure.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/model/bus_spec.hpp"
#include "core/model/command.hpp"

namespace fieldcast {

struct ProbedChannel {
  std::string name;
  std::optional<Value> value;
  Cause cause = Cause::kNone;
  std::string reason;      // one line; empty with a value
  bool responded = false;  // with a value, a refusal, or items that are not a value
  Instant at{};            // of the result
  Duration took{};         // from the request to the result
};

struct ProbedDevice {
  std::string name;
  std::vector<ProbedChannel> channels;  // those that were requested, or could not be
};

class DeviceProbe {
 public:
  // Limits of one probe; what exceeds them is left out.
  static constexpr std::size_t kMostDevices = 16, kMostChannels = 32;
  // Requests without a response, after which a device that has never responded is left.
  static constexpr std::size_t kMostSilent = 2;

  // `expires`: latest start of a request. `questions`: number of first channels of each device that
  // only show whether it responds. The first response ends them; the channels behind them follow,
  // up to one without a value.
  DeviceProbe(std::vector<DeviceSpec> devices, Instant expires, std::size_t questions = 0);

  // Empty at the end of the probe. The same command until its result. `request_id` counts from 1.
  [[nodiscard]] std::optional<Command> next() const;
  void on_result(const CommandResult& result);
  // One for each device that was begun.
  [[nodiscard]] const std::vector<ProbedDevice>& devices() const { return probed_; }
  // Whether nothing more can be sent after a result with this cause.
  [[nodiscard]] static bool ends_probe(Cause cause);

 private:
  // The channel behind the last one; empty if the device is left.
  [[nodiscard]] std::optional<std::size_t> channel_after(const ProbedDevice& device) const;

  std::vector<std::shared_ptr<const DeviceSpec>> specs_;
  Instant expires_;
  std::size_t questions_;
  std::vector<ProbedDevice> probed_;
  std::size_t channel_ = 0;  // the next one of the last device
  std::uint64_t requests_ = 0;
  bool ended_ = false;  // nothing more can be sent
};

}  // namespace fieldcast
