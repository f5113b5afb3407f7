// Records the traffic on a bus's wire: to the trace on stdout and to the tap of a capture. If
// neither is active, the cost is two flag checks. Runs on the bus's thread.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <utility>

#include "bridge/capture/bus_capture.hpp"
#include "core/base/bytes.hpp"
#include "core/bus/setup/event.hpp"

namespace fieldcast {

class BusEngine;

class WireRecord {
 public:
  explicit WireRecord(std::string bus) : bus_(std::move(bus)) {}

  void set_trace(bool on) { trace_ = on; }
  void set_tap(std::shared_ptr<CaptureTap> tap) { tap_ = std::move(tap); }
  [[nodiscard]] const std::shared_ptr<CaptureTap>& tap() const { return tap_; }
  // Returns true if the engine must report how it interprets the bytes.
  [[nodiscard]] bool wanted() const { return trace_ || capturing(); }

  // `engine` supplies the polled device and the request.
  void sent(ByteView bytes, const BusEngine& engine, UtcTime at);
  void received(ByteView bytes, UtcTime at);
  void frame_ended(UtcTime at);
  void traced(const Traced& traced, UtcTime at) const;
  // Explains the capture, for example a port that opens or a lease.
  void remark(const std::string& text, UtcTime at) const;

 private:
  [[nodiscard]] bool capturing() const { return tap_ && tap_->wanted(); }
  // Whether bytes that arrive now belong to a frame that the capture does not have; notes them.
  [[nodiscard]] bool unseen_frame_continues(UtcTime at);

  const std::string bus_;
  bool trace_ = false;
  std::shared_ptr<CaptureTap> tap_;
  // Arrival of the last bytes of a frame that began before the capture, which begins behind it.
  std::optional<UtcTime> unseen_;
};

}  // namespace fieldcast
