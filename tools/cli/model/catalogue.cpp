#include "tools/cli/model/catalogue.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <vector>

#include "core/base/message_text.hpp"

namespace fieldcast::cli {
namespace {

std::string unknown(std::string_view kind, const std::string& name, std::vector<std::string> known,
                    const std::string& where) {
  std::sort(known.begin(), known.end());
  known.erase(std::unique(known.begin(), known.end()), known.end());
  std::string text = fmt::format("{} '{}' is unknown{}", kind, name, where);
  if (const auto near = near_miss(name, known); !near.empty())
    return fmt::format("{}; did you mean {}?", text, near);
  constexpr std::size_t kListed = 8;
  text += "; there ";
  text += known.size() == 1 ? "is " : "are ";
  for (std::size_t i = 0; i < std::min(kListed, known.size()); ++i)
    text += (i == 0 ? "" : ", ") + known[i];
  return known.size() > kListed ? text + ", .. (fieldcast watch lists them)" : text;
}

}  // namespace

void Catalogue::add(const StationChannel& channel) {
  add_device(channel.bus, channel.device);
  channels_[{channel.bus, channel.device, channel.channel}] = channel;
}

const StationChannel* Catalogue::find(const ChannelPath& path) const {
  const auto found = channels_.find(path);
  return found == channels_.end() ? nullptr : &found->second;
}

bool Catalogue::add_device(const std::string& bus, const std::string& device) {
  return devices_.emplace(bus, device).second;
}

bool Catalogue::has_device(const std::string& bus, const std::string& device) const {
  return devices_.contains({bus, device});
}

bool Catalogue::has_bus(const std::string& bus) const {
  const auto first = devices_.lower_bound({bus, ""});
  return first != devices_.end() && first->first == bus;
}

std::size_t Catalogue::count(const Pattern& pattern) const {
  return static_cast<std::size_t>(
      std::count_if(channels_.begin(), channels_.end(), [&](const auto& entry) {
        return pattern.matches(entry.first.bus, entry.first.device, entry.first.channel);
      }));
}

std::string Catalogue::meant_further_down(const Pattern& pattern) const {
  std::string text = pattern.text();
  while (text.ends_with("/*")) {
    text = "*/" + text.substr(0, text.size() - 2);
    if (const auto moved = Pattern::parse(text); moved && count(*moved) != 0) return text;
    if (text.starts_with("*/*/")) break;
  }
  return {};
}

std::string Catalogue::explain_unknown(const ChannelPath& path) const {
  std::vector<std::string> buses, devices, names;
  for (const auto& [bus, device] : devices_) {
    buses.push_back(bus);
    if (bus == path.bus) devices.push_back(device);
  }
  for (const auto& [known, channel] : channels_) {
    if (known.bus == path.bus && known.device == path.device) names.push_back(known.channel);
  }
  if (buses.empty()) return "no device is announced at all";
  for (const std::string& site : silent_sites_) {
    if (path.bus.starts_with(site + ':')) return "no bridge found in site " + site;
  }
  if (devices.empty()) return unknown("bus", path.bus, std::move(buses), "");
  if (!has_device(path.bus, path.device))
    return unknown("device", path.device, std::move(devices), " on bus " + path.bus);
  if (names.empty())
    return fmt::format("device '{}' has no channels; --at ADDRESS reads and writes addresses",
                       path.device);
  return unknown("channel", path.channel, std::move(names),
                 fmt::format(" in {}/{}", path.bus, path.device));
}

}  // namespace fieldcast::cli
