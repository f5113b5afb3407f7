// The standby groups of a domain as a station sees them: which bridge is master, which ones wait,
// and a request for another master.
//
// Joins the domain with a participant of its own. Handlers come on DDS threads.
#pragma once

#include <functional>
#include <memory>
#include <string>

#include "bridge/dds/dds_error.hpp"
#include "bridge/dds/topics/conversion_standby.hpp"
#include "core/model/spec.hpp"

namespace fieldcast {

class StandbyMonitor {
 public:
  struct Handlers {
    std::function<void(const StandbyMessage&)> member;
    std::function<void(const std::string& group, const std::string& bridge)> gone;
  };
  // Throws DdsError.
  StandbyMonitor(const DdsSpec& spec, const std::string& name, Handlers handlers);
  ~StandbyMonitor();
  StandbyMonitor(const StandbyMonitor&) = delete;
  StandbyMonitor& operator=(const StandbyMonitor&) = delete;

  // Asks the group for another master. False: no bridge heard it within the limit. Throws DdsError:
  // this member may not.
  [[nodiscard]] bool request(const StandbyRequest& wanted, Duration limit);

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace fieldcast
