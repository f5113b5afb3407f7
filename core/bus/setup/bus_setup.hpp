// Data of a bus engine, which owns it; the parts keep references. Only the ad-hoc devices change.
// On the bus's thread.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <unordered_map>
#include <utility>
#include <vector>

#include "core/bus/setup/event.hpp"
#include "core/model/bus_spec.hpp"
#include "core/model/sample.hpp"
#include "core/protocol/protocol.hpp"
#include "core/protocol/protocol_entry.hpp"

namespace fieldcast {

class BusSetup {
 public:
  explicit BusSetup(const BusSpec& spec);
  BusSetup(const BusSetup&) = delete;
  BusSetup& operator=(const BusSetup&) = delete;

  [[nodiscard]] const BusSpec& spec() const { return spec_; }
  [[nodiscard]] const LineFormat& line() const { return line_; }
  // Required silence of the wire after each response.
  [[nodiscard]] Duration silence() const { return silence_; }
  [[nodiscard]] bool plain_tcp() const;
  [[nodiscard]] bool datagrams() const { return has_datagrams(spec_.port); }
  // The bytes have no times of a line: protocols of networks on a plain TCP connection.
  [[nodiscard]] bool timeless() const { return timeless_; }
  // See ProtocolEntry. REQUIRES: spec().in_flight > 1.
  [[nodiscard]] std::optional<std::size_t> first_frame(ByteView stream) const {
    return framer_(stream);
  }

  [[nodiscard]] std::size_t devices() const { return spec_.devices.size(); }
  [[nodiscard]] const DeviceSpec& device(DeviceIndex device) const {
    return is_ad_hoc(device) ? ad_hoc_[device - devices()] : spec_.devices[device];
  }
  [[nodiscard]] const Protocol& protocol(DeviceIndex device) const { return *protocols_[device]; }
  [[nodiscard]] const Area& area(DeviceIndex device, AreaIndex area) const {
    return protocol(device).areas()[area];
  }
  // Null for an index without an ad-hoc device.
  [[nodiscard]] const std::vector<std::shared_ptr<const Protocol>>& protocols() const {
    return protocols_;
  }
  [[nodiscard]] std::optional<DeviceIndex> find(std::string_view name) const;

  // Devices that are not configured, and are read by commands (Command::ad_hoc). Their indices
  // follow those of the configured devices, up to slots(). The number is enough for a search of
  // silent addresses, as a late response is possible for three timeouts.
  static constexpr std::size_t kMostAdHoc = 8;
  [[nodiscard]] std::size_t slots() const { return devices() + kMostAdHoc; }
  [[nodiscard]] bool is_ad_hoc(DeviceIndex device) const { return device >= devices(); }
  [[nodiscard]] std::optional<DeviceIndex> find_ad_hoc(const DeviceSpec& device) const;
  // Why a request to the device could disturb the configured ones; empty if it cannot.
  [[nodiscard]] std::optional<std::string> why_not_ad_hoc(const DeviceSpec& device) const;
  // Replaces the ad-hoc device of this index. Returns false if its protocol cannot be made.
  // REQUIRES: why_not_ad_hoc() is empty; no request to the former device is pending, and no
  // response unless both have the same link.
  [[nodiscard]] bool set_ad_hoc(DeviceIndex index, const DeviceSpec& device);

  // Both exclude the device's own response time.
  [[nodiscard]] Duration wire_time(DeviceIndex device, const Request& request) const;
  [[nodiscard]] Duration response_wire_time(DeviceIndex device, const Request& request) const;
  // Returns true if bytes that equal the request can only be an echo.
  [[nodiscard]] bool response_differs(DeviceIndex device, const Request& request) const;

  // Human-readable, for example "holding:105..107".
  [[nodiscard]] std::string text(DeviceIndex device, const Range& range) const;

 private:
  BusSpec spec_;
  LineFormat line_;
  Duration silence_;
  bool timeless_;
  Framer framer_ = nullptr;
  std::vector<std::shared_ptr<const Protocol>> protocols_;
  std::unordered_map<std::string_view, DeviceIndex> names_;
  std::vector<DeviceSpec> ad_hoc_;
};

// Both have the same protocol and address, so that their responses are alike.
[[nodiscard]] bool same_address(const DeviceSpec& a, const DeviceSpec& b);

// Each device speaks a protocol that frames its own stream, so no serial line carries it.
[[nodiscard]] bool only_network_protocols(const BusSpec& bus);

[[nodiscard]] AreaIndex area_of(const Request& request);

// Appends the actions of one event; keeps references to the event's actions and the engine's setup.
class ActionSink {
 public:
  // `samples`: counter of published samples.
  ActionSink(const BusSetup& setup, std::uint64_t& samples, Actions& actions, bool tracing = false)
      : setup_(setup), samples_(samples), actions_(actions), tracing_(tracing) {}

  void publish(std::vector<Sample> samples) {
    samples_ += samples.size();
    publish_uncounted(std::move(samples));
  }
  // Publishes without counting: first samples, and samples that only report a lease.
  void publish_uncounted(std::vector<Sample> samples) {
    if (!samples.empty()) push(Publish{std::move(samples)});
  }
  void notice(Notice::Kind kind, DeviceIndex device, Cause cause, std::string text) {
    push(Notice{kind, setup_.device(device).name, cause, std::move(text)});
  }
  [[nodiscard]] bool tracing() const { return tracing_; }
  // REQUIRES: tracing().
  void trace(DeviceIndex device, std::string text) {
    push(Traced{setup_.device(device).name, std::move(text)});
  }
  void push(Action action) { actions_.push_back(std::move(action)); }

 private:
  const BusSetup& setup_;
  std::uint64_t& samples_;
  Actions& actions_;
  bool tracing_;
};

}  // namespace fieldcast
