#include "tools/station/api/device_templates.hpp"

#include <algorithm>
#include <tuple>

#include "config/files/file_reader.hpp"

namespace fieldcast::web {

namespace {

constexpr std::string_view kSuffix = ".yaml", kDevice = "# Device:";

std::string_view trimmed(std::string_view text) {
  const auto first = text.find_first_not_of(" []\r");
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(" []\r") - first + 1);
}

// The rest of the first line that begins with this word.
std::string_view line_after(std::string_view text, std::string_view word) {
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t end = std::min(text.find('\n', at), text.size());
    const std::string_view line = text.substr(at, end - at);
    if (line.starts_with(word)) return trimmed(line.substr(word.size()));
    at = end + 1;
  }
  return {};
}

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
  DeviceTemplate made{.name = std::move(name), .text = std::move(text)};
  const std::string_view device = line_after(made.text, kDevice);
  if (device.empty()) {
    made.model = std::string(line_after(made.text, "description:"));
  } else {
    const std::size_t end = maker_size(device);
    made.maker = std::string(device.substr(0, end));
    made.model = std::string(trimmed(device.substr(end)));
  }
  std::string_view protocol = line_after(made.text, "protocols:");
  if (protocol.empty()) protocol = line_after(made.text, "protocol:");
  made.protocol = std::string(protocol);
  return made;
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
      return std::tie(each.maker, each.model, each.name);
    });
    return found;
  }();
  return all;
}

}  // namespace fieldcast::web
