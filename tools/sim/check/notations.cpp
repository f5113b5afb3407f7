#include "tools/sim/check/notations.hpp"

#include <algorithm>
#include <charconv>
#include <span>

namespace fieldcast::sim {
namespace {

using List = std::span<const char* const>;

constexpr const char* kModbus[] = {"coil:3",
                                   "coil:0x1F",
                                   "input:5",
                                   "input:0x5",
                                   "discrete-input:6",
                                   "holding:100",
                                   "holding:0x65",
                                   "discrete-input:0x7",
                                   "holding:0XfF",
                                   "holding:110.5",
                                   "holding:0x70.5",
                                   "holding:113.0xA",
                                   "holding:65535",
                                   "input-register:7",
                                   "input-register:0x8",
                                   "input-register:9.15",
                                   "input-register:0xA.0x3",
                                   "00010",
                                   "10010",
                                   "30021",
                                   "30022.1",
                                   "40201",
                                   "40202.15",
                                   "000011",
                                   "100011",
                                   "300031",
                                   "465001"};
constexpr const char* kDtc[] = {"bit:7",      "int16:100", "int16:101.3", "int32:5",
                                "int32:6.31", "float32:6", "float64:7",   "int16:65535"};
constexpr const char* kFxClassic[] = {
    "D100",    "D101.3", "D102.15", "D8010", "D8011.2", "T5", "TN6", "C5",  "CN6", "C200", "CN201",
    "C202.31", "M14",    "M8001",   "X17",   "Y5",      "S3", "TS5", "TC5", "CS5", "CC5"};
constexpr const char* kFxExtended[] = {"D100", "D101.3", "D8010", "T5",  "TN6", "C5",
                                       "CN6",  "M14",    "M8001", "X17", "Y5",  "S3"};
constexpr const char* kOmronC[] = {"CIO12",   "IR13",   "CIO14.03", "LR7",   "L8",   "HR10",
                                   "H11",     "AR3",    "A4",       "DM100", "D101", "DM102.15",
                                   "EM1_100", "E1_101", "E1_102.3", "T5",    "TIM6", "C5",
                                   "CNT6",    "TF5",    "TIMF6",    "CF5",   "CNTF6"};
constexpr const char* kOmronFins[] = {
    "CIO12", "IR13", "CIO14.03", "W5",   "WR6",      "W7.07",   "HR10", "H11",
    "AR3",   "A4",   "DM100",    "D101", "DM102.15", "EM1_100", "EC_5", "E1_102.3",
    "T5",    "TIM6", "C5",       "CNT6", "TF5",      "TIMF6",   "CF5",  "CNTF6"};
constexpr const char* kFreeport[] = {"window:0", "window:1", "window:3", "window:2.7"};
constexpr const char* kPpi[] = {
    "VB100", "VW102", "VD104", "V108.3", "MB1",  "MW2",  "MD4", "M9.7", "IB0", "IW2",
    "ID4",   "I9.3",  "QB0",   "QW2",    "QD4",  "Q9.0", "SB0", "SW2",  "SD4", "S9.1",
    "SMB28", "SMW30", "SMD34", "SM0.1",  "AIW4", "AQW2", "T37", "C5",   "HC0"};

List list_of(const Subject& subject) {
  const std::string& protocol = subject.device.protocol;
  const auto option = [&](const char* name) {
    const auto found = subject.device.link.options.find(name);
    return found == subject.device.link.options.end() ? std::string{} : found->second;
  };
  if (protocol.starts_with("modbus-")) return kModbus;
  if (protocol == "dtc") return kDtc;
  if (protocol == "mitsubishi-fx")
    return option("commands") == "extended" ? List(kFxExtended) : List(kFxClassic);
  if (protocol == "omron-hostlink")
    return option("mode") == "fins" ? List(kOmronFins) : List(kOmronC);
  if (protocol == "s7-freeport") return kFreeport;
  return protocol == "s7-ppi" ? List(kPpi) : List();
}

std::string number(std::uint32_t number, int base) {
  char text[16];
  const auto [end, error] = std::to_chars(text, text + sizeof text, number, base);
  return {text, end};
}

// As the declaration spells numbers; hexadecimal digits in either case.
void add_numbered(const declared::DeclaredArea& area, std::vector<std::string>& all) {
  const std::uint32_t last = area.origin + area.items - 1;
  const auto add = [&](std::uint32_t item) {
    const std::string text = number(item, area.base);
    std::string upper = text;
    std::ranges::transform(upper, upper.begin(), [](char c) {
      return c >= 'a' && c <= 'z' ? static_cast<char>(c - 'a' + 'A') : c;
    });
    all.push_back(area.prefix + text);
    if (upper != text) all.push_back(area.prefix + upper);
  };
  add(area.origin);
  if (area.items > 1) add(last);
  if (area.items > 31) add(area.origin + 30);
  if (area.item_bits > 1 && area.items > 2)
    all.push_back(area.prefix + number(area.origin + 1, area.base) + ".3");
}

}  // namespace

std::vector<std::string> notations_of(const Subject& subject) {
  if (!subject.device.declaration) {
    const List list = list_of(subject);
    return {list.begin(), list.end()};
  }
  std::vector<std::string> all;
  for (const declared::DeclaredArea& area : subject.device.declaration.value->areas) {
    if (!area.record) add_numbered(area, all);
    for (const declared::Place& place : area.places) {
      all.push_back(place.name);
      if (place.bits != 0) all.push_back(place.name + '.' + std::to_string(place.bits - 1));
    }
  }
  return all;
}

Encoding natural_encoding(const ParsedAddress& address, const Area& area,
                          const declared::Declaration* declaration) {
  Encoding encoding;
  encoding.word_order = area.word_order;
  encoding.bit = address.bit;
  if (area.item_bits == 1 || address.bit) {
    encoding.type = ValueType::kBool;
    return encoding;
  }
  if (declaration != nullptr && declaration->areas[address.area].record && !address.width_bits) {
    for (const declared::Place& place : declaration->areas[address.area].places) {
      if (place.first != address.first) continue;
      encoding.type = ValueType::kString;
      encoding.string_bytes = static_cast<std::uint16_t>(2 * place.items);
    }
    return encoding;
  }
  switch (address.width_bits.value_or(area.item_bits)) {
    case 8: encoding.type = ValueType::kUint8; break;
    case 32: encoding.type = ValueType::kUint32; break;
    case 64: encoding.type = ValueType::kUint64; break;
    default: encoding.type = ValueType::kUint16;
  }
  return encoding;
}

}  // namespace fieldcast::sim
