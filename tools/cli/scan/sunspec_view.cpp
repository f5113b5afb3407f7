#include "tools/cli/scan/sunspec_view.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <span>

namespace fieldcast::cli {

namespace {

// Types of SunSpec points. An acc32 marks a point that is not implemented by 0, which is also a
// valid value.
enum class PointType : std::uint8_t { kInt16, kUint16, kEnum16, kAcc32, kBits32, kText8, kText16 };
struct TypeRow {
  std::uint32_t registers;
  std::string_view keys;
};
constexpr TypeRow type_row(PointType type) {
  switch (type) {
    case PointType::kInt16: return {1, "type: int16, not-available: 0x8000"};
    case PointType::kUint16:
    case PointType::kEnum16: return {1, "type: uint16, not-available: 0xFFFF"};
    case PointType::kAcc32: return {2, "type: uint32"};
    case PointType::kBits32: return {2, "type: uint32, not-available: 0xFFFFFFFF"};
    case PointType::kText8: return {8, "type: string(16), mode: on-demand"};
    case PointType::kText16: return {16, "type: string(32), mode: on-demand"};
  }
  return {};
}

// Offsets are in registers from the header of the model or the start of a repeated block.
struct SunSpecPoint {
  std::string_view name;
  std::uint32_t offset;
  PointType type;
  std::string_view unit = {};
  std::uint32_t exponent = 0;  // offset of the scale factor from the header; 0: none
  unsigned phases = 1;         // minimum number of phases of a model with this point
};

using enum PointType;

constexpr SunSpecPoint kCommon[] = {
    {"manufacturer", 2, kText16},
    {"model", 18, kText16},
    {"version", 42, kText8},
    {"serial-number", 50, kText16},
};

constexpr SunSpecPoint kInverter[] = {
    {"ac-current", 2, kUint16, "A", 6},
    {"ac-current-l1", 3, kUint16, "A", 6},
    {"ac-current-l2", 4, kUint16, "A", 6, 2},
    {"ac-current-l3", 5, kUint16, "A", 6, 3},
    {"ac-voltage-l1-l2", 7, kUint16, "V", 13, 2},
    {"ac-voltage-l2-l3", 8, kUint16, "V", 13, 3},
    {"ac-voltage-l3-l1", 9, kUint16, "V", 13, 3},
    {"ac-voltage-l1", 10, kUint16, "V", 13},
    {"ac-voltage-l2", 11, kUint16, "V", 13, 2},
    {"ac-voltage-l3", 12, kUint16, "V", 13, 3},
    {"ac-power", 14, kInt16, "W", 15},
    {"frequency", 16, kUint16, "Hz", 17},
    {"apparent-power", 18, kInt16, "VA", 19},
    {"reactive-power", 20, kInt16, "var", 21},
    {"power-factor", 22, kInt16, "%", 23},
    {"energy", 24, kAcc32, "Wh", 26},
    {"dc-current", 27, kUint16, "A", 28},
    {"dc-voltage", 29, kUint16, "V", 30},
    {"dc-power", 31, kInt16, "W", 32},
    {"cabinet-temperature", 33, kInt16, "°C", 37},
    {"heatsink-temperature", 34, kInt16, "°C", 37},
    {"state", 38, kEnum16},
    {"state-vendor", 39, kEnum16},
    {"events", 40, kBits32},
};

constexpr SunSpecPoint kMeter[] = {
    {"current", 2, kInt16, "A", 6},
    {"current-l1", 3, kInt16, "A", 6},
    {"current-l2", 4, kInt16, "A", 6, 2},
    {"current-l3", 5, kInt16, "A", 6, 3},
    {"voltage", 7, kInt16, "V", 15},
    {"voltage-l1", 8, kInt16, "V", 15},
    {"voltage-l2", 9, kInt16, "V", 15, 2},
    {"voltage-l3", 10, kInt16, "V", 15, 3},
    {"voltage-phase-to-phase", 11, kInt16, "V", 15, 2},
    {"voltage-l1-l2", 12, kInt16, "V", 15, 2},
    {"voltage-l2-l3", 13, kInt16, "V", 15, 3},
    {"voltage-l3-l1", 14, kInt16, "V", 15, 3},
    {"frequency", 16, kInt16, "Hz", 17},
    {"active-power", 18, kInt16, "W", 22},
    {"active-power-l1", 19, kInt16, "W", 22},
    {"active-power-l2", 20, kInt16, "W", 22, 2},
    {"active-power-l3", 21, kInt16, "W", 22, 3},
    {"apparent-power", 23, kInt16, "VA", 27},
    {"reactive-power", 28, kInt16, "var", 32},
    {"power-factor", 33, kInt16, "%", 37},
    {"energy-export", 38, kAcc32, "Wh", 54},
    {"energy-import", 46, kAcc32, "Wh", 54},
    {"events", 105, kBits32},
};

// Points of each input of model 160.
constexpr SunSpecPoint kInput[] = {
    {"current", 9, kUint16, "A", 2},   {"voltage", 10, kUint16, "V", 3},
    {"power", 11, kUint16, "W", 4},    {"energy", 12, kAcc32, "Wh", 5},
    {"temperature", 16, kInt16, "°C"}, {"state", 17, kEnum16},
    {"events", 18, kBits32},
};
// A read of 125 registers cannot contain the exponents and the seventh input.
constexpr std::uint32_t kFirstInput = 10, kInputRegisters = 20, kMostInputs = 6;

struct ModelRow {
  std::uint16_t number;
  std::string_view name, kind;  // of the model; prefix of channel names
  unsigned phases;
  std::span<const SunSpecPoint> points;
  // points of a block that is repeated to the end of the model
  std::span<const SunSpecPoint> input;
};
constexpr ModelRow kSunSpecModels[] = {
    {1, "common", "common", 1, kCommon, {}},
    {101, "inverter, one phase", "inverter", 1, kInverter, {}},
    {102, "inverter, split phase", "inverter", 2, kInverter, {}},
    {103, "inverter, three phases", "inverter", 3, kInverter, {}},
    {160, "inputs of an inverter", "input", 1, {}, kInput},
    {201, "meter, one phase", "meter", 1, kMeter, {}},
    {202, "meter, split phase", "meter", 2, kMeter, {}},
    {203, "meter, three phases in star", "meter", 3, kMeter, {}},
    {204, "meter, three phases in delta", "meter", 3, kMeter, {}},
};

const ModelRow* model_row(std::uint16_t number) {
  const auto* row = std::ranges::find(kSunSpecModels, number, &ModelRow::number);
  return row == std::end(kSunSpecModels) ? nullptr : row;
}

class ModelChannels {
 public:
  ModelChannels(const SunSpecModel& model, std::vector<std::string>& lines)
      : model_(model), lines_(lines) {}

  // `block`: start of a repeated block, or 0.
  void add(std::span<const SunSpecPoint> points, unsigned phases, const std::string& prefix,
           std::uint32_t block) {
    for (const SunSpecPoint& point : points) {
      const TypeRow type = type_row(point.type);
      if (point.phases > phases || !holds(block + point.offset, type.registers) ||
          !holds(point.exponent, 1))
        continue;
      std::string line = fmt::format("{{ name: {}-{}, at: \"holding:{}\", {}", prefix, point.name,
                                     model_.first + block + point.offset, type.keys);
      if (point.exponent != 0)
        line += fmt::format(", exponent-from: \"holding:{}\"", model_.first + point.exponent);
      if (!point.unit.empty()) line += fmt::format(", unit: \"{}\"", point.unit);
      lines_.push_back(line + " }");
    }
  }
  [[nodiscard]] bool holds(std::uint32_t offset, std::uint32_t registers) const {
    return offset + registers <= kSunSpecHeader + model_.length;
  }

 private:
  const SunSpecModel& model_;
  std::vector<std::string>& lines_;
};

}  // namespace

std::string_view sunspec_model_name(std::uint16_t number) {
  const ModelRow* row = model_row(number);
  return row == nullptr ? std::string_view{} : row->name;
}

std::vector<std::string> sunspec_channels(const SunSpecMap& map) {
  std::vector<std::string> lines;
  std::map<std::string_view, unsigned> counts;  // by kind
  for (const SunSpecModel& model : map.models) {
    const ModelRow* row = model_row(model.number);
    if (row == nullptr) continue;
    std::string prefix(row->kind);
    if (const unsigned count = ++counts[row->kind]; count > 1) prefix += fmt::format("-{}", count);
    ModelChannels channels(model, lines);
    channels.add(row->points, row->phases, prefix, 0);
    if (row->input.empty()) continue;
    std::uint32_t block = kFirstInput;
    for (unsigned input = 1; input <= kMostInputs && channels.holds(block, kInputRegisters);
         ++input, block += kInputRegisters)
      channels.add(row->input, row->phases, fmt::format("{}-dc{}", prefix, input), block);
  }
  return lines;
}

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
