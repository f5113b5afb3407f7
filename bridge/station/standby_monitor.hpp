// The standby groups of a domain, for a station: which bridge is master and which wait; can request
// another master. Joins the domain with its own participant. Handlers run on DDS threads.
#pragma once

#include <functional>
#include <memory>
#include <string>

#include "bridge/dds/library/library.hpp"
#include "bridge/dds/topics/conversion.hpp"
#include "core/model/dds_spec.hpp"

namespace fieldcast {

class StandbyMonitor {
 public:
  struct Handlers {
    std::function<void(const StandbyMessage&)> member;
    std::function<void(const std::string& group, const std::string& bridge)> gone;
  };
  StandbyMonitor(const DdsSpec& spec, const std::string& name, Handlers handlers);
  ~StandbyMonitor();
  StandbyMonitor(const StandbyMonitor&) = delete;
  StandbyMonitor& operator=(const StandbyMonitor&) = delete;

  // Requests another master of the group. Returns false if no bridge received it within the limit.
  // Throws DdsError if this member has no right to do so.
  [[nodiscard]] bool request(const StandbyRequest& wanted, Duration limit);

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace fieldcast
