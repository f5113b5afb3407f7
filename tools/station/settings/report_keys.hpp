// The section `reports` of a station.
#pragma once

#include <vector>

#include "config/document/map_reader.hpp"
#include "tools/station/notify/notify_spec.hpp"
#include "tools/station/report/report_spec.hpp"

namespace fieldcast::web {

[[nodiscard]] const config::Rows<ReportSpec>& report_rows();

// Adds faults; with faults the result is incomplete. `targets`: those of the section `notify`.
void read_reports(config::MapReader& file, const std::vector<NotifyTarget>& targets,
                  std::vector<ReportSpec>& reports);

}  // namespace fieldcast::web
