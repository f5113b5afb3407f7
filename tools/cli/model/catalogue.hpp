// The channels that the bridges of the domain announced, and the devices that they report, as far
// as they arrived. A device that is there for commands to addresses alone has no channel. Pure: fed
// by whoever listens.
#pragma once

#include <map>
#include <optional>
#include <set>
#include <string>
#include <string_view>

#include "bridge/station/station.hpp"
#include "core/model/channel_path.hpp"
#include "core/model/pattern.hpp"

namespace fieldcast::cli {

class Catalogue {
 public:
  void add(const StationChannel& channel);
  // True when it is new.
  bool add_device(const std::string& bus, const std::string& device);
  // No bridge of this site of a station was found: its buses are not known, which is no fault of
  // their names.
  void add_silent_site(std::string site) { silent_sites_.insert(std::move(site)); }
  void remove(const ChannelPath& path) { channels_.erase(path); }

  [[nodiscard]] const StationChannel* find(const ChannelPath& path) const;
  [[nodiscard]] const std::map<ChannelPath, StationChannel>& channels() const { return channels_; }
  [[nodiscard]] bool has_device(const std::string& bus, const std::string& device) const;
  [[nodiscard]] bool has_bus(const std::string& bus) const;
  [[nodiscard]] bool empty() const { return devices_.empty(); }  // nobody is there
  [[nodiscard]] std::size_t count(const Pattern& pattern) const;

  // Of a pattern that matches nothing: one that does when its parts are taken for a device, or
  // for a channel ("*/*/voltage" for "voltage"). Empty: none.
  [[nodiscard]] std::string meant_further_down(const Pattern& pattern) const;

  // Why find() found nothing, which part of the path is at fault, and what was probably meant.
  [[nodiscard]] std::string explain_unknown(const ChannelPath& path) const;

 private:
  std::map<ChannelPath, StationChannel> channels_;
  std::set<std::pair<std::string, std::string>> devices_;  // with their bus
  std::set<std::string> silent_sites_;
};

}  // namespace fieldcast::cli
