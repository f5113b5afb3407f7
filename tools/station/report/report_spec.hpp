// Reports that the station makes by itself. Plain values.
#pragma once

#include <string>
#include <vector>

#include "core/model/channel_pattern.hpp"
#include "tools/station/report/report.hpp"

namespace fieldcast::web {

struct ReportSpec {
  std::string name;
  std::vector<Pattern> channels;
  ReportBy by = ReportBy::kDay;
  std::vector<int> shifts{6 * 60, 14 * 60, 22 * 60};  // minutes of the day
  // Each day about the day before, or on the first of each month about the month before.
  bool monthly = false;
  int at = 6 * 60 + 10;           // minute of the local day
  bool csv = false;               // instead of XLSX
  std::string folder;             // empty: no file
  std::vector<std::string> mail;  // names of targets
};

}  // namespace fieldcast::web
