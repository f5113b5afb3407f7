#include "config/sections/capture.hpp"

#include <fmt/format.h>

#include "config/document/limits.hpp"
#include "config/document/scalars.hpp"
#include "config/sections/bus_keys.hpp"

namespace fieldcast::config {
namespace {

constexpr std::pair<std::string_view, std::int64_t> kCaptureUnits[] = {
    {"kB", 1'000}, {"MB", 1'000'000}, {"GB", 1'000'000'000}};
constexpr std::string_view kCaptureSizes = "100kB to 1000GB, with kB, MB or GB";

}  // namespace

std::optional<std::int64_t> CaptureSizeRule::operator()(const Node& node, std::string_view key,
                                                        FaultList& faults) const {
  constexpr auto kMax = static_cast<std::int64_t>(kMaxCaptureBytes);
  constexpr auto kMin = static_cast<std::int64_t>(kMinCaptureBytes);
  const std::string* text = scalar_of(node, key, kCaptureSizes, faults);
  if (text == nullptr) return std::nullopt;
  for (const auto& [unit, worth] : kCaptureUnits) {
    if (!text->ends_with(unit)) continue;
    const auto number = whole_from(std::string_view(*text).substr(0, text->size() - unit.size()));
    if (!number || *number < 0) continue;
    if (*number <= kMax / worth && *number * worth >= kMin) return *number * worth;
    faults.add(node.position, fmt::format("{} '{}' is out of range", key, *text),
               std::string(kCaptureSizes));
    return std::nullopt;
  }
  faults.add(node.position, fmt::format("{} '{}' cannot be understood", key, *text),
             std::string(kCaptureSizes));
  return std::nullopt;
}
std::string CaptureSizeRule::schema() const {
  return R"({ "type": "string", "pattern": "^[0-9]+(kB|MB|GB)$" })";
}
std::string CaptureSizeRule::form() const { return "100kB to 1000GB"; }

void read_capture(MapReader& bus, std::optional<CaptureSpec>& spec) {
  const Node* node = bus.find("capture");
  if (node == nullptr) return;
  MapReader map(*node, capture_rows(), bus.faults());
  CaptureSpec capture;
  capture_rows().read(map, capture);
  capture.folder = resolve(*map.position().source, capture.folder);
  spec = std::move(capture);
}

}  // namespace fieldcast::config
