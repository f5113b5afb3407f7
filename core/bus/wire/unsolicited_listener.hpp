// Finds the frames that devices of a bus send without a request. Owns the bytes of frames that are
// not yet whole, one buffer for each device with such frames. Owned by the bus engine, on the bus's
// thread.
#pragma once

#include <vector>

#include "core/bus/setup/bus_setup.hpp"

namespace fieldcast {

class UnsolicitedListener {
 public:
  // A frame never pauses that long; its beginning is then discarded.
  static constexpr Duration kLongestPause = std::chrono::seconds{1};
  static constexpr std::size_t kMostKept = 8192;  // bytes of a device

  struct Frame {
    DeviceIndex device = 0;
    Range range;
    Bytes items;                // the image of `range`
    std::vector<Range> absent;  // parts of `range` without a value
  };

  explicit UnsolicitedListener(const BusSetup& setup);

  // Whether a device of the bus sends unsolicited frames.
  [[nodiscard]] bool active() const { return !senders_.empty(); }
  // Call for all bytes of the port. Returns the frames that they complete.
  [[nodiscard]] std::vector<Frame> on_bytes(ByteView bytes, Instant now);
  void opened();

  // Devices that are not polled and have sent nothing for the longest refresh of their channels;
  // each once for every such silence.
  [[nodiscard]] std::vector<DeviceIndex> silent(Instant now);
  // When to call silent() again.
  [[nodiscard]] Instant next_silence() const;

 private:
  struct Sender {
    DeviceIndex device = 0;
    Duration patience{};  // see silent(); zero: the device is polled as well
    Bytes kept;
    bool boundary = false;  // `kept` begins behind a frame
    Instant silent_since = kNever;
  };

  const BusSetup& setup_;
  std::vector<Sender> senders_;
  Instant last_byte_ = kLongAgo;
};

}  // namespace fieldcast
