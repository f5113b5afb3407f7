// Lines and responses of a scan.
#pragma once

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tools/cli/scan/scan_plan.hpp"
#include "tools/cli/scan/scanner.hpp"

namespace fieldcast::cli {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

inline NamedProtocol rtu() { return {find_protocol("modbus-rtu"), {}}; }

inline std::vector<ScanLine> lines_of(std::size_t formats, std::vector<std::uint16_t> addresses) {
  auto usual = usual_formats(rtu(), {}, {});
  usual.resize(formats);
  return scan_lines(rtu(), usual, addresses);
}

inline ScanResponse value() {
  return {.device = true, .took = std::chrono::milliseconds{3}, .bytes = 7};
}
inline ScanResponse silence() { return {.cause = Cause::kNoResponse}; }
inline ScanResponse noise() { return {.cause = Cause::kChecksum, .bytes = 3}; }

inline std::vector<ScanLine> probed_lines(std::size_t formats,
                                          std::vector<std::uint16_t> addresses) {
  auto lines = lines_of(formats, std::move(addresses));
  plan_probes(lines);
  return lines;
}

}  // namespace fieldcast::cli
