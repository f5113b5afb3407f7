// What is captured of one bus: takes the records of its tap, makes frames of them, writes each
// frame as a block of pcapng, and gives the block to whoever captures the bus now.
//
// Owned by the capture service, on its thread. The sinks are borrowed: they outlive their stay.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "bridge/capture/capture_tap.hpp"
#include "core/capture/frame_gatherer.hpp"
#include "core/model/spec.hpp"

namespace fieldcast {

// Takes the blocks of one capture. On the service's thread; must not wait for long.
class CaptureSink {
 public:
  virtual ~CaptureSink() = default;
  // One whole block of a packet.
  virtual void packet(ByteView block, UtcTime at) = 0;
  // Records that the bus had to drop.
  virtual void lost(std::uint64_t records) = 0;
};

class BusCapture {
 public:
  // `by`: who speaks on the bus, for the head of each file: "bridge press-shop".
  BusCapture(const BusSpec& bus, const std::string& by, std::shared_ptr<CaptureTap> tap);

  void add(CaptureSink& sink);
  void remove(CaptureSink& sink);
  [[nodiscard]] bool busy() const { return !sinks_.empty(); }

  // What every file and every stream begins with.
  [[nodiscard]] Bytes head(const std::string& remark = {}) const;
  // Gives out what came since the last call.
  void drain(UtcTime now);
  // The same, and what waits for more of its frame.
  void finish(UtcTime now);

 private:
  struct Dissector {
    std::string name, column;
  };
  void give(std::vector<CapturedFrame>& frames);

  const std::string bus_, about_;
  std::vector<Dissector> dissectors_;  // by device
  const std::shared_ptr<CaptureTap> tap_;
  FrameGatherer gatherer_;
  std::vector<CaptureSink*> sinks_;
};

// The end of a capture: how many frames it has, and how many pieces the bus dropped.
struct CaptureCounts {
  UtcTime begun, ended;
  std::uint64_t frames = 0, dropped = 0;
};
[[nodiscard]] Bytes capture_tail(const CaptureCounts& counts, const std::string& why = {});

}  // namespace fieldcast
