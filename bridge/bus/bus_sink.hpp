// Destination of a bus's samples, results and reports: DDS in the daemon, a record in the tests of
// the runner. Called only on the bus's io thread.
#pragma once

#include <string_view>
#include <vector>

#include "core/base/time.hpp"
#include "core/model/command.hpp"
#include "core/model/sample.hpp"
#include "core/model/status.hpp"
#include "core/plan/read_plan.hpp"

namespace fieldcast {

// A bus that measures its devices changes its plan often in its first seconds.
inline constexpr Duration kPlanReportGap = std::chrono::seconds{5};

class BusSink {
 public:
  virtual ~BusSink() = default;
  virtual void publish(std::vector<Sample> samples, const UtcMapping& mapping) = 0;
  virtual void promise(ChannelIndex channel, std::optional<Duration> gap) = 0;
  virtual void complete(const CommandResult& result, const UtcMapping& mapping) = 0;
  virtual void report(const BusReport& report, UtcTime at) = 0;
  virtual void report(std::string_view device, const DeviceReport& report, UtcTime at) = 0;
  // A new plan is in use. Called once for the first plan, then at most every kPlanReportGap.
  virtual void report(PlanReport plan, UtcTime at) = 0;
};

}  // namespace fieldcast
