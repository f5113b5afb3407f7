// Where it is told what passes on the wire of a bus: the trace on stdout, and the tap of a capture.
// What nobody wants costs a look at two flags.
//
// On the bus's thread. Nothing can fail.
#pragma once

#include <memory>
#include <string>
#include <utility>

#include "bridge/capture/capture_tap.hpp"
#include "core/base/bytes.hpp"
#include "core/bus/event.hpp"

namespace fieldcast {

class BusEngine;

class WireRecord {
 public:
  explicit WireRecord(std::string bus) : bus_(std::move(bus)) {}

  void set_trace(bool on) { trace_ = on; }
  void set_tap(std::shared_ptr<CaptureTap> tap) { tap_ = std::move(tap); }
  // Whether the engine is to say what it makes of the bytes.
  [[nodiscard]] bool wanted() const { return trace_ || capturing(); }

  // `engine`: knows which device is asked, and for what.
  void sent(ByteView bytes, const BusEngine& engine, UtcTime at) const;
  void received(ByteView bytes, UtcTime at) const;
  // No more bytes belong to the frame.
  void frame_ended(UtcTime at) const;
  void traced(const Traced& traced, UtcTime at) const;
  // What explains a capture: a port that opens, a lease.
  void remark(const std::string& text, UtcTime at) const;

 private:
  [[nodiscard]] bool capturing() const { return tap_ && tap_->wanted(); }

  const std::string bus_;
  bool trace_ = false;
  std::shared_ptr<CaptureTap> tap_;  // null: nobody captures this bus
};

}  // namespace fieldcast
