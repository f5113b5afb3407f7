#include "config/document/baud.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <vector>

#include "config/document/scalars.hpp"
#include "core/base/message_text.hpp"

namespace fieldcast::config {
namespace {

// Rates of termios(3) from 300 on, of the S7-200's PPI (93750, 187500), and of common crystals.
constexpr std::array<std::uint32_t, 29> kBauds{
    300,    600,    1200,   1800,    2400,    4800,    9600,    14400,   19200,  28800,
    38400,  57600,  76800,  93750,   115200,  125000,  187500,  230400,  250000, 460800,
    500000, 576000, 921600, 1000000, 1152000, 1500000, 2000000, 3000000, 4000000};

std::string baud_list() {
  std::string text;
  for (const auto baud : kBauds) text += fmt::format("{}{}", text.empty() ? "" : ", ", baud);
  return text;
}

// A similar number (an extra or wrong digit), and the nearest common rate.
std::string likely_bauds(std::uint32_t baud) {
  static constexpr std::array<std::uint32_t, 10> kUsual{1200,  2400,  4800,   9600,   19200,
                                                        38400, 57600, 115200, 230400, 460800};
  std::vector<std::string> usual(kUsual.size());
  std::ranges::transform(kUsual, usual.begin(), [](auto rate) { return std::to_string(rate); });
  const auto slip = near_miss(std::to_string(baud), usual);
  const auto ratio = [&](std::uint32_t rate) {
    return std::max(rate, baud) / static_cast<double>(std::min(rate, baud));
  };
  const auto near = *std::ranges::min_element(kUsual, {}, ratio);
  std::string text = slip;
  if (ratio(near) < 1.25 && std::to_string(near) != slip)
    text += fmt::format("{}{}", text.empty() ? "" : " or ", near);
  return text;
}

}  // namespace

std::optional<std::uint32_t> BaudRule::operator()(const Node& node, std::string_view key,
                                                  FaultList& faults) const {
  const auto value = WholeRule{1, kBauds.back()}(node, key, faults);
  if (!value) return std::nullopt;
  const auto baud = static_cast<std::uint32_t>(*value);
  if (std::ranges::find(kBauds, baud) != kBauds.end()) return baud;
  faults.add(node.position, fmt::format("baud {} is no rate of serial ports", baud), baud_list(),
             likely_bauds(baud));
  return std::nullopt;
}

std::string BaudRule::form() { return "a rate that serial ports have"; }

std::string BaudRule::schema() {
  std::vector<std::string> texts(kBauds.size());
  std::ranges::transform(kBauds, texts.begin(), [](auto rate) { return std::to_string(rate); });
  return schema_of_words(std::vector<std::string_view>(texts.begin(), texts.end()));
}

}  // namespace fieldcast::config
