#pragma once

#include <string>

#include "core/schedule/bus_schedule.hpp"
#include "tools/cli/command/base/command.hpp"

namespace fieldcast::cli {

struct DoctorOptions {
  std::string config;      // empty: checks only the machine
  std::string root = "/";  // root of the file system; "/": also joins the domain of `config`
  bool json = false;
  std::string security;  // the folder of a member, to join with; empty: that of the configuration
};

// Returns kFound if part of the configuration cannot run, kUsage if the file has faults.
[[nodiscard]] ExitCode doctor(const DoctorOptions& options, const Streams& to);

struct PlanOptions {
  std::string config;
  bool json = false;
  Duration response_time = kAssumedResponseTime;
  Duration simulate{};  // virtual time with simulated devices; 0: only plan
  std::uint64_t seed = 1;
  std::string faults;  // file with the faults of the simulated plant; empty: none
};

// Returns kFound if a bus cannot keep its refresh times, kUsage if a file has faults.
[[nodiscard]] ExitCode plan(const PlanOptions& options, const Streams& to);

}  // namespace fieldcast::cli
