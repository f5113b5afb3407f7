// What the facts of a machine mean for Fieldcast. Pure: facts in, findings out.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "tools/cli/doctor/facts.hpp"

namespace fieldcast::cli {

enum class Severity : std::uint8_t {
  kOk,        // was looked at and is as it should be
  kAdvice,    // it runs, slower or less surely than it could
  kPrevents,  // something of the configuration cannot run
};
[[nodiscard]] std::string_view severity_text(Severity severity);  // "ok", "advice", "prevents"

struct Finding {
  Severity severity = Severity::kOk;
  std::string check;  // "receive buffer"
  std::string where;  // the file, port or address; may be empty
  std::string what;
  std::string remedy;  // what to type or to change; empty: nothing
  friend bool operator==(const Finding&, const Finding&) = default;
};

// In the order of the checks; of facts that are not known there is no finding.
[[nodiscard]] std::vector<Finding> findings_of(const MachineFacts& facts);

// The worst of them; kOk for none.
[[nodiscard]] Severity worst_of(const std::vector<Finding>& findings);

}  // namespace fieldcast::cli
