// Learns how short the silence between a response and the next request may be on this line
// (`silence: learn`). The standard (Modbus over Serial Line V1.02, 2.5.1.1) gives old devices time
// to find the end of a frame; most need less. A search shortens the silence by about a third at a
// time. Each step must serve each device several times. The silence in use is one step longer than
// the shortest that was accepted.
//
// While a device does not respond, the standard is in use, so that a short silence is never the
// reason. It stays in use for a while after the first failure that directly follows a short
// silence. A second one at a step that is not proven excludes this step and all shorter ones. Pure
// value, owned by Wire, on the bus's thread.
#pragma once

#include <cstddef>
#include <vector>

#include "core/base/time.hpp"
#include "core/model/sample.hpp"
#include "core/protocol/protocol.hpp"

namespace fieldcast {

class SilenceLearning {
 public:
  static constexpr double kStep = 0.7;        // of the step before
  static constexpr unsigned kTries = 16;      // responses of each device that accept a step
  static constexpr unsigned kProven = 1024;   // responses after which a failure is only noise
  static constexpr unsigned kPatience = 256;  // responses with the standard after a failure

  // `least`: no silence is shorter, except a shorter standard.
  SilenceLearning(Duration standard, Duration least, std::size_t devices);

  // To keep after the exchange that ends now.
  [[nodiscard]] Duration silence() const { return steps_[silent_ == 0 ? step_ : 0]; }
  // An exchange ended. `rest`: between the end of the last exchange and its request.
  void ended(DeviceIndex device, Duration rest, bool responded);

 private:
  struct Device {
    bool responds = false;   // to the last request
    unsigned responses = 0;  // at this step
  };
  void responded(Device& device);
  void failed();
  void enter(std::size_t step);
  [[nodiscard]] bool all_accept() const;

  std::vector<Duration> steps_;  // from the standard downwards
  std::vector<Device> devices_;
  std::size_t silent_;  // devices that did not respond to their last request
  std::size_t step_ = 0;
  std::size_t next_;  // to enter after the wait with the standard
  std::size_t last_;  // shortest step that is not excluded
  bool searching_ = true;
  unsigned wait_ = 0;       // responses with the standard that are left
  unsigned responses_ = 0;  // at this step
  unsigned failures_ = 0;   // at step next_, before it was proven
};

}  // namespace fieldcast
