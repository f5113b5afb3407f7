#include "core/model/port_spec.hpp"

namespace fieldcast {
namespace {

std::optional<LineFormat> known_line(const PortSpec& port) {
  return std::visit([](const auto& each) { return each.known_line(); }, port);
}

}  // namespace

std::string to_text(const LineFormat& line) {
  static constexpr char kParity[] = {'N', 'E', 'O'};
  return std::to_string(line.baud) + ' ' + std::to_string(line.data_bits) +
         kParity[static_cast<int>(line.parity)] + std::to_string(line.stop_bits);
}

std::string_view to_text(Fence fence) {
  switch (fence) {
    case Fence::kNone: return "none";
    case Fence::kListen: return "listen";
    case Fence::kLock: return "lock";
    case Fence::kOneClient: return "one-client";
  }
  return "?";
}

const FenceSpec& fence_of(const PortSpec& port) {
  return std::visit([](const auto& each) -> const FenceSpec& { return each.fence; }, port);
}

std::string name_of(const PortSpec& port) {
  return std::visit([](const auto& each) { return each.name(); }, port);
}

std::string to_text(const PortSpec& port) {
  const auto line = known_line(port);
  return name_of(port) + (line ? ' ' + to_text(*line) : std::string{});
}

bool over_network(const PortSpec& port) {
  return std::visit([](const auto& each) { return each.kOverNetwork; }, port);
}

bool has_line(const PortSpec& port) { return known_line(port).has_value(); }

bool has_datagrams(const PortSpec& port) {
  return std::visit([](const auto& each) { return each.has_datagrams(); }, port);
}

bool has_tls(const PortSpec& port) {
  return std::visit([](const auto& each) { return each.has_tls(); }, port);
}

// A plain TCP device has no character time; only its requests have a significant cost.
LineFormat line_of(const PortSpec& port) {
  return known_line(port).value_or(LineFormat{100'000'000, 8, Parity::kNone, 1});
}

}  // namespace fieldcast
