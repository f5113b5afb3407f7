// The channels that the bridges of the domain announced, as far as they arrived. Pure: fed by whoever listens.
#pragma once

#include <compare>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <tl/expected.hpp>

#include "bridge/dds/station.hpp"
#include "core/model/pattern.hpp"

namespace fieldcast::cli {

struct ChannelPath {
  std::string bus, device, channel;

  // "BUS/DEVICE/CHANNEL", all three; the fault is a line for people.
  [[nodiscard]] static tl::expected<ChannelPath, std::string> parse(std::string_view text);
  [[nodiscard]] std::string text() const { return bus + '/' + device + '/' + channel; }
  friend auto operator<=>(const ChannelPath&, const ChannelPath&) = default;
};

class Catalogue {
 public:
  void add(const StationChannel& channel);
  void remove(const ChannelPath& path) { channels_.erase(path); }

  [[nodiscard]] const StationChannel* find(const ChannelPath& path) const;
  [[nodiscard]] const std::map<ChannelPath, StationChannel>& channels() const { return channels_; }
  [[nodiscard]] bool has_device(std::string_view bus, std::string_view device) const;
  [[nodiscard]] std::size_t count(const Pattern& pattern) const;

  // Why find() found nothing, which part of the path is at fault, and what was probably meant.
  [[nodiscard]] std::string explain_unknown(const ChannelPath& path) const;

 private:
  std::map<ChannelPath, StationChannel> channels_;
};

}  // namespace fieldcast::cli
