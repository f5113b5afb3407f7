#include "tools/cli/view/doctor_view.hpp"

namespace fieldcast::cli {

namespace {

Tone tone_of(Severity severity) {
  switch (severity) {
    case Severity::kOk: return Tone::kGood;
    case Severity::kAdvice: return Tone::kWarning;
    case Severity::kPrevents: return Tone::kBad;
  }
  return Tone::kPlain;
}

}  // namespace

std::vector<std::string> doctor_lines(const std::vector<Finding>& findings, const Screen& screen) {
  std::vector<std::string> lines;
  for (const Finding& finding : findings) {
    std::string severity(severity_text(finding.severity));
    severity.resize(severity_text(Severity::kPrevents).size(), ' ');
    std::string line =
        painted(severity, tone_of(finding.severity), screen.colour) + "  " + finding.check;
    if (!finding.where.empty()) line += " (" + printable(finding.where) + ")";
    lines.push_back(line + ": " + printable(finding.what));
    if (!finding.remedy.empty())
      lines.push_back(std::string(severity.size() + 2, ' ') + "-> " + printable(finding.remedy));
  }
  return lines;
}

Json finding_json(const Finding& finding) {
  return {{"severity", severity_text(finding.severity)},
          {"check", finding.check},
          {"where", finding.where},
          {"what", finding.what},
          {"remedy", finding.remedy}};
}

}  // namespace fieldcast::cli
