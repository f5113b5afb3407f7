// Recognises the repetition of a response. Some devices send a response twice without a pause. The
// operating system and adapters deliver received bytes late, so the repetition may arrive behind
// the next request, at a time when the response to this request is possible. README.md has the
// rules. Owned by LateResponseFilter, on the bus's thread.
#pragma once

#include <vector>

#include "core/base/bytes.hpp"
#include "core/base/time.hpp"
#include "core/frame/line.hpp"
#include "core/model/sample.hpp"

namespace fieldcast {

class RepetitionFilter {
 public:
  // After a repetition, the wire rests behind so many responses of the device.
  static constexpr unsigned kWatched = 1024;

  // `longest_delay`: of received bytes.
  RepetitionFilter(const LineFormat& line, Duration longest_delay, std::size_t devices)
      : line_(line), longest_delay_(longest_delay), watched_(devices) {}

  // A response or a refusal of the device. `expected`: characters of a response; 0 if unknown.
  // `at`: arrival of its last byte.
  void responded(DeviceIndex device, ByteView received, std::size_t expected, Instant at);
  // Bytes without a request. REQUIRES: no late response can arrive.
  void stray(ByteView bytes, Instant now);
  void asked() {
    strays_.clear();
    discarded_ = false;
  }
  // The frame of find() is not the response. It was a repetition if a response follows.
  void discard() {
    frame_.clear();
    discarded_ = true;
  }
  // Another device has the index now.
  void replaced(DeviceIndex device) { watched_[device] = 0; }

  // Number of bytes up to the end of a frame that equals the last response; 0 if there is none, or
  // if a repetition would have arrived before the request was sent at `asked`.
  [[nodiscard]] std::size_t find(ByteView received, Instant asked) const;
  // The repetition of the last response has arrived at that time. kLongAgo if the device does not
  // repeat its responses.
  [[nodiscard]] Instant rest_until() const {
    return watched_[device_] > 0 ? arrived_until() : kLongAgo;
  }
  [[nodiscard]] bool watches(DeviceIndex device) const { return watched_[device] > 0; }

 private:
  void repeated();
  [[nodiscard]] Instant arrived_until() const {
    return at_ + line_.characters(static_cast<double>(frame_.size())) + longest_delay_;
  }

  LineFormat line_;
  Duration longest_delay_;
  std::vector<unsigned> watched_;  // responses of each device until it counts as healthy
  DeviceIndex device_ = 0;
  Bytes frame_;  // the last response; empty behind its repetition
  Instant at_ = kLongAgo;
  bool discarded_ = false;
  Bytes strays_;  // behind the last response
};

}  // namespace fieldcast
