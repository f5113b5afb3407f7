// Announced channels and reported devices, as far as received; a device may have no channel. Pure.
#pragma once

#include <map>
#include <optional>
#include <set>
#include <string>
#include <string_view>

#include "bridge/station/station.hpp"
#include "core/model/channel_pattern.hpp"

namespace fieldcast::cli {

class Catalogue {
 public:
  void add(const StationChannel& channel);
  // Returns true if the device is new.
  bool add_device(const std::string& bus, const std::string& device);
  // No bridge of this site was found: its buses are unknown even if their names are correct.
  void add_silent_site(std::string site) { silent_sites_.insert(std::move(site)); }
  void remove(const ChannelPath& path) { channels_.erase(path); }

  [[nodiscard]] const StationChannel* find(const ChannelPath& path) const;
  [[nodiscard]] const std::map<ChannelPath, StationChannel>& channels() const { return channels_; }
  [[nodiscard]] bool has_device(const std::string& bus, const std::string& device) const;
  [[nodiscard]] bool has_bus(const std::string& bus) const;
  [[nodiscard]] bool empty() const { return devices_.empty(); }  // no bridge has reported
  [[nodiscard]] std::size_t count(const Pattern& pattern) const;

  // Returns a matching pattern at device or channel level ("*/*/voltage" for "voltage"), or an
  // empty text.
  [[nodiscard]] std::string meant_further_down(const Pattern& pattern) const;

  // Explains which part of the path is unknown, and suggests the closest name.
  [[nodiscard]] std::string explain_unknown(const ChannelPath& path) const;

 private:
  std::map<ChannelPath, StationChannel> channels_;
  std::set<std::pair<std::string, std::string>> devices_;  // (bus, device)
  std::set<std::string> silent_sites_;
};

}  // namespace fieldcast::cli
