#include "tools/station/api/device_templates.hpp"

#include <algorithm>
#include <nlohmann/json.hpp>
#include <tuple>

namespace fieldcast::web {

namespace {

constexpr std::string_view kSuffix = ".yaml";

// Makers whose names have two words.
constexpr std::string_view kLongMakers[] = {"Carlo Gavazzi", "Schneider Electric",
                                            "inepro Metering", "Tripp Lite"};

std::size_t maker_size(std::string_view device) {
  for (const std::string_view maker : kLongMakers) {
    if (device.starts_with(maker)) return maker.size();
  }
  return std::min(device.find(' '), device.size());
}

}  // namespace

DeviceTemplate device_template_of(std::string name, std::string text) {
  DeviceTemplate made{.head = config::template_head(std::move(name), text),
                      .maker = {},
                      .model = {},
                      .text = std::move(text)};
  const std::string& device = made.head.device;
  const std::size_t end = maker_size(device);
  made.maker = device.substr(0, end);
  made.model =
      device.empty() ? made.head.description : device.substr(std::min(end + 1, device.size()));
  return made;
}

std::string with_templates(const std::string& scan, const std::vector<DeviceTemplate>& templates) {
  auto body = nlohmann::json::parse(scan, nullptr, false);
  const auto found = body.is_object() ? body.find("found") : body.end();
  if (found == body.end() || !found->is_array()) return scan;
  std::vector<config::TemplateHead> heads;
  for (const DeviceTemplate& each : templates) heads.push_back(each.head);
  const auto text_of = [](const nlohmann::json& device, const char* name) {
    const auto text = device.find(name);
    return text != device.end() && text->is_string() ? text->get<std::string>() : std::string();
  };
  for (auto& device : *found) {
    if (device.is_object())
      device["templates"] = config::matching_templates(text_of(device, "identity"),
                                                       text_of(device, "protocol"), heads);
  }
  return to_string(body);
}

const std::vector<DeviceTemplate>& device_templates() {
  static const std::vector<DeviceTemplate> all = [] {
    std::vector<DeviceTemplate> found;
    const config::FileReader disk = config::disk_reader();
    for (const std::string& folder : config::default_options().template_directories) {
      for (const std::string& file : disk.list(folder)) {
        if (!file.ends_with(kSuffix)) continue;
        if (auto text = disk.read(folder + '/' + file))
          found.push_back(
              device_template_of(file.substr(0, file.size() - kSuffix.size()), *std::move(text)));
      }
    }
    std::ranges::sort(found, {}, [](const DeviceTemplate& each) {
      return std::tie(each.maker, each.model, each.head.name);
    });
    return found;
  }();
  return all;
}

}  // namespace fieldcast::web
