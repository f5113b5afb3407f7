// Capture of one bus: joins the records of its tap to frames, encodes each frame as a pcapng block
// and passes it to every sink.
//
// Owned by the capture service, on its thread. A sink must live until it is removed.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "bridge/capture/capture_tap.hpp"
#include "core/capture/capture_record.hpp"
#include "core/model/bus_spec.hpp"

namespace fieldcast {

// Receives the blocks of one capture on the service's thread; must not block.
class CaptureSink {
 public:
  virtual ~CaptureSink() = default;
  virtual void packet(ByteView block, UtcTime at) = 0;
  virtual void lost(std::uint64_t records) = 0;
};

class BusCapture {
 public:
  // `by`: the program that polls the bus, for the head of each file: "bridge press-shop".
  BusCapture(const BusSpec& bus, const std::string& by, std::shared_ptr<CaptureTap> tap);

  void add(CaptureSink& sink);
  void remove(CaptureSink& sink);
  [[nodiscard]] bool busy() const { return !sinks_.empty(); }

  // First blocks of every file and every stream.
  [[nodiscard]] Bytes head(const std::string& remark = {}) const;
  void drain(UtcTime now);
  // As drain(), and also passes on incomplete frames.
  void finish(UtcTime now);

 private:
  struct Dissector {
    std::string name, column;
  };
  void give(std::vector<CapturedFrame>& frames);

  const std::string bus_, about_;
  std::vector<Dissector> dissectors_;
  const std::shared_ptr<CaptureTap> tap_;
  FrameGatherer gatherer_;
  std::vector<CaptureSink*> sinks_;
};

// Counts in the last block of a capture: frames, and records that the bus dropped.
struct CaptureCounts {
  UtcTime begun, ended;
  std::uint64_t frames = 0, dropped = 0;
};
[[nodiscard]] Bytes capture_tail(const CaptureCounts& counts, const std::string& why = {});

}  // namespace fieldcast
