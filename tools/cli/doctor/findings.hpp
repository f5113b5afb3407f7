#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "tools/cli/doctor/facts.hpp"

namespace fieldcast::cli {

enum class Severity : std::uint8_t {
  kOk,        // checked and correct
  kAdvice,    // works, but slower or less reliably than possible
  kPrevents,  // part of the configuration cannot run
};
[[nodiscard]] std::string_view severity_text(Severity severity);  // "ok", "advice", "prevents"

struct Finding {
  Severity severity = Severity::kOk;
  std::string check;  // "receive buffer"
  std::string where;  // file, port or address; may be empty
  std::string what;
  std::string remedy;  // command or change that fixes it; empty: none
  friend bool operator==(const Finding&, const Finding&) = default;
};

// In the order of the checks; unknown facts have no finding.
[[nodiscard]] std::vector<Finding> findings_of(const MachineFacts& facts);

// Returns kOk if there are no findings.
[[nodiscard]] Severity worst_of(const std::vector<Finding>& findings);

}  // namespace fieldcast::cli
