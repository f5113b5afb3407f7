// A report as a spreadsheet. Stateless; blocks for the time of the compression.
#pragma once

#include <string>
#include <tl/expected.hpp>
#include <vector>

#include "tools/station/report/report.hpp"

namespace fieldcast::web {

// The bytes of an XLSX file with the columns of report_csv(). Times are local, without a zone.
// Fails with the reason if there is no memory or no space for temporary files.
[[nodiscard]] tl::expected<std::string, std::string> report_xlsx(
    const std::vector<ReportTable>& tables);

}  // namespace fieldcast::web
