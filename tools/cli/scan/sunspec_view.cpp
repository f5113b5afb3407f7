#include "tools/cli/scan/sunspec_view.hpp"

#include <fmt/format.h>

#include "tools/cli/scan/sunspec_channels.hpp"

namespace fieldcast::cli {
namespace {

std::string models_text(const SunSpecMap& map) {
  std::string text;
  for (const SunSpecModel& model : map.models) {
    const std::string_view name = sunspec_model_name(model.number);
    text += fmt::format("{}{}{}", text.empty() ? "" : ", ", model.number,
                        name.empty() ? "" : fmt::format(" ({})", name));
  }
  return text.empty() ? "none" : text;
}

}  // namespace

bool may_have_sunspec(std::string_view protocol) {
  return protocol == "modbus-rtu" || protocol == "modbus-ascii" || protocol == "modbus-tcp";
}

std::string sunspec_identity(const SunSpecMap& map) {
  std::string text;
  for (const std::string* part : {&map.manufacturer, &map.model, &map.version}) {
    if (!part->empty()) text += (text.empty() ? "" : ", ") + *part;
  }
  if (!map.serial_number.empty())
    text += (text.empty() ? "serial number " : ", serial number ") + map.serial_number;
  return text;
}

std::vector<std::string> sunspec_lines(std::uint16_t address, const SunSpecMap& map) {
  std::vector<std::string> lines{fmt::format("address {}: SunSpec models from holding:{} on: {}",
                                             address, map.base, models_text(map))};
  if (!map.incomplete.empty())
    lines.push_back(
        fmt::format("address {}: the list of models is not whole: {}", address, map.incomplete));
  return lines;
}

Json sunspec_json(const SunSpecMap& map) {
  Json models = Json::array();
  for (const SunSpecModel& model : map.models)
    models.push_back(Json{{"number", model.number}, {"at", model.first}, {"length", model.length}});
  return Json{{"base", map.base},
              {"manufacturer", map.manufacturer},
              {"model", map.model},
              {"version", map.version},
              {"serial_number", map.serial_number},
              {"models", std::move(models)},
              {"incomplete", map.incomplete}};
}

std::string sunspec_comment(const SunSpecMap& map) {
  std::string text =
      fmt::format("        # SunSpec models from holding:{} on: {}\n", map.base, models_text(map));
  if (!map.incomplete.empty())
    text += fmt::format("        # the list of models is not whole: {}\n", map.incomplete);
  return text;
}

}  // namespace fieldcast::cli
