#include "tools/cli/view/check_view.hpp"

#include <fmt/format.h>

#include <algorithm>

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

namespace {

constexpr std::size_t kBytesShown = 8;  // of one field, in its line

std::string bytes_text(ByteView frame, const FrameField& field) {
  const auto first = std::min(field.offset, frame.size());
  const auto length = std::min(field.length, frame.size() - first);
  const auto shown = to_hex(frame.subspan(first, std::min(length, kBytesShown)));
  return length > kBytesShown ? shown + " .." : shown;
}

}  // namespace

std::size_t count_faults(std::span<const FrameField> fields) {
  return static_cast<std::size_t>(std::count_if(
      fields.begin(), fields.end(), [](const auto& field) { return !field.fault.empty(); }));
}

std::vector<std::string> inspect_lines(std::string_view protocol, ByteView frame,
                                       std::span<const FrameField> fields, const Screen& screen) {
  TextTable table({{""}, {"at", Align::kRight}, {"bytes"}, {"field"}, {"value"}, {""}});
  for (const auto& field : fields) {
    const bool bad = !field.fault.empty();
    const auto tone = bad ? Tone::kBad : Tone::kPlain;
    table.add_row({{bad ? "!!" : "", Tone::kBad},
                   {field.length == 0 ? "" : std::to_string(field.offset), Tone::kFaint},
                   {bytes_text(frame, field), tone},
                   {std::string(2 * std::size_t{field.depth}, ' ') + field.name, tone},
                   {field.value, tone},
                   {bad ? "<- " + field.fault : "", Tone::kBad}});
  }
  auto lines = table.render(screen);
  const auto faults = count_faults(fields);
  lines.push_back(fmt::format(
      "{}, {} bytes: {}", protocol, frame.size(),
      faults == 0 ? "no fault" : fmt::format("{}{}", faults, faults == 1 ? " fault" : " faults")));
  return lines;
}

Json inspect_json(std::string_view protocol, ByteView frame, std::span<const FrameField> fields) {
  Json list = Json::array();
  for (const auto& field : fields) {
    list.push_back({{"depth", field.depth},
                    {"offset", field.offset},
                    {"length", field.length},
                    {"name", field.name},
                    {"value", field.value},
                    {"fault", field.fault}});
  }
  return {{"protocol", protocol},
          {"frame", to_hex(frame, '\0')},
          {"fields", list},
          {"faults", count_faults(fields)}};
}

}  // namespace fieldcast::cli
