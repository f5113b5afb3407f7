// What does not change while a bus engine runs: the bus as configured, what its line costs, and the
// protocol of each device. Made once and owned by the engine; its parts keep a reference. Runs on
// the bus's thread like the engine. Nothing here can fail: the loader has checked the
// configuration.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <unordered_map>
#include <vector>

#include "core/model/sample.hpp"
#include "core/model/spec.hpp"
#include "core/protocol/protocol.hpp"

namespace fieldcast {

class BusSetup {
 public:
  // REQUIRES: spec is as the loader makes it (every protocol known, every address inside its area).
  explicit BusSetup(const BusSpec& spec);
  BusSetup(const BusSetup&) = delete;
  BusSetup& operator=(const BusSetup&) = delete;

  [[nodiscard]] const BusSpec& spec() const { return spec_; }
  [[nodiscard]] const LineFormat& line() const { return line_; }
  // The wire must be silent for this long after each answer.
  [[nodiscard]] Duration silence() const { return silence_; }
  // Bytes come over a connection that carries no serial line: it can be closed to begin anew.
  [[nodiscard]] bool plain_tcp() const;

  [[nodiscard]] std::size_t devices() const { return spec_.devices.size(); }
  [[nodiscard]] const DeviceSpec& device(DeviceIndex device) const { return spec_.devices[device]; }
  [[nodiscard]] const Protocol& protocol(DeviceIndex device) const { return *protocols_[device]; }
  [[nodiscard]] const Area& area(DeviceIndex device, AreaIndex area) const {
    return protocol(device).areas()[area];
  }
  // One for each device; shared with plans that are made elsewhere.
  [[nodiscard]] const std::vector<std::shared_ptr<const Protocol>>& protocols() const {
    return protocols_;
  }
  [[nodiscard]] std::optional<DeviceIndex> find(std::string_view name) const;

  // Wire time of the request and its answer, and of the answer alone; without the device's own
  // time.
  [[nodiscard]] Duration wire_time(DeviceIndex device, const Request& request) const;
  [[nodiscard]] Duration answer_wire_time(DeviceIndex device, const Request& request) const;
  // No answer to this request can equal it: what comes back and equals it is an echo.
  [[nodiscard]] bool answer_differs(DeviceIndex device, const Request& request) const;

  // "holding:105..107", for people.
  [[nodiscard]] std::string text(DeviceIndex device, const Range& range) const;

 private:
  BusSpec spec_;
  LineFormat line_;
  Duration silence_;
  std::vector<std::shared_ptr<const Protocol>> protocols_;
  std::unordered_map<std::string_view, DeviceIndex> names_;
};

// The area that a request is about.
[[nodiscard]] AreaIndex area_of(const Request& request);

}  // namespace fieldcast
