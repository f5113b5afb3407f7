// Where a bus's samples, results and reports go. In the daemon this is DDS; in the tests of the
// runner it is a record. Called on the bus's io thread only.
#pragma once

#include <string_view>
#include <vector>

#include "bridge/dds/topics/utc_mapping.hpp"
#include "core/model/command.hpp"
#include "core/model/sample.hpp"
#include "core/model/status.hpp"
#include "core/plan/plan_report.hpp"

namespace fieldcast {

// A bus that learns changes its plan often in its first seconds.
inline constexpr Duration kPlanReportGap = std::chrono::seconds{5};

class BusSink {
 public:
  virtual ~BusSink() = default;
  virtual void publish(std::vector<Sample> samples, const UtcMapping& mapping) = 0;
  virtual void promise(ChannelIndex channel, std::optional<Duration> gap) = 0;
  virtual void complete(const CommandResult& result, const UtcMapping& mapping) = 0;
  virtual void report(const BusReport& report, UtcTime at) = 0;
  virtual void report(std::string_view device, const DeviceReport& report, UtcTime at) = 0;
  // Another plan is in force: once for the first, then at most every kPlanReportGap.
  virtual void report(PlanReport plan, UtcTime at) = 0;
};

}  // namespace fieldcast
