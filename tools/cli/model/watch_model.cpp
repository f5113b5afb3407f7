#include "tools/cli/model/watch_model.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <utility>
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

void RateMeter::count(Instant now) {
  if (!began_) began_ = now;
  if (now - *began_ >= kWindow) {
    last_ = static_cast<double>(counted_) / to_seconds(now - *began_);
    began_ = now;
    counted_ = 0;
  }
  ++counted_;
}

double RateMeter::rate(Instant now) const {
  if (!began_) return 0;
  const double elapsed = to_seconds(now - *began_);
  if (last_ != 0 && elapsed < to_seconds(kWindow)) return last_;
  // The first window, or an old one after samples stopped. A burst at the start is not a rate.
  return counted_ < 2 || elapsed < 0.1 ? 0 : static_cast<double>(counted_ - 1) / elapsed;
}

WatchModel::Row* WatchModel::row(const ChannelPath& path) {
  if (!pattern_.matches(path.bus, path.device, path.channel)) return nullptr;
  if (const auto found = rows_.find(path); found != rows_.end()) return &found->second;
  if (rows_.size() >= kMaxChannels) return nullptr;
  auto& row = rows_[path];
  row.sample.bus = path.bus;
  row.sample.device = path.device;
  row.sample.channel = path.channel;
  return &row;
}

void WatchModel::on_channel(const StationChannel& channel) {
  announced_ = true;
  if (auto* known = row({channel.bus, channel.device, channel.channel}); known != nullptr) {
    known->gone = false;
    catalogue_.add(channel);
  } else if (rows_.empty() && others_.channels().size() < kMaxChannels) {
    others_.add(channel);
  }
}

bool WatchModel::on_sample(const StationSample& sample, Instant now) {
  announced_ = true;
  auto* known = row({sample.bus, sample.device, sample.channel});
  if (known == nullptr) return false;
  known->sample = sample;
  known->gone = false;
  known->rate.count(now);
  rate_.count(now);
  ++samples_;
  return true;
}

bool WatchModel::on_gone(const ChannelPath& path) {
  catalogue_.remove(path);
  const auto found = rows_.find(path);
  return found != rows_.end() && !std::exchange(found->second.gone, true);
}

bool WatchModel::is_gone(const ChannelPath& path) const {
  const auto found = rows_.find(path);
  return found != rows_.end() && found->second.gone;
}

std::size_t WatchModel::good() const {
  return static_cast<std::size_t>(std::count_if(rows_.begin(), rows_.end(), [](const auto& entry) {
    return !entry.second.gone && entry.second.sample.quality == Quality::kGood;
  }));
}

std::size_t WatchModel::sampled() const {
  return static_cast<std::size_t>(std::count_if(rows_.begin(), rows_.end(), [](const auto& entry) {
    return entry.second.sample.sequence != 0;
  }));
}

std::size_t WatchModel::awaited(bool interested) const {
  return static_cast<std::size_t>(std::count_if(rows_.begin(), rows_.end(), [&](const auto& entry) {
    const auto* about = catalogue_.find(entry.first);
    return !entry.second.gone && entry.second.sample.quality == Quality::kNotYetRead &&
           about != nullptr && (interested || about->refresh != Duration{});
  }));
}

std::optional<std::string> WatchModel::interest_remark(Duration refresh) const {
  if (catalogue_.channels().empty()) {
    return fmt::format(
        "the interest in {} meets nothing: no announced channel matches; fieldcast watch --once "
        "lists them",
        pattern_.text());
  }
  std::size_t slower = 0, unread = 0;
  for (const auto& [path, channel] : catalogue_.channels()) {
    slower += channel.refresh > refresh ? 1 : 0;
    unread += channel.refresh == Duration::zero() ? 1 : 0;
  }
  if (slower + unread == 0) return std::nullopt;
  std::string why;
  if (slower != 0) why = fmt::format("{} are read anyway, less often (acquire: always)", slower);
  if (unread != 0)
    why += fmt::format("{}{} are not read by themselves (on-demand or write-only)",
                       why.empty() ? "" : ", ", unread);
  return fmt::format("the interest in {} every {} changes nothing for {} of {} channels: {}",
                     pattern_.text(), to_text(refresh), slower + unread,
                     catalogue_.channels().size(), why);
}

std::optional<std::string> WatchModel::lag_remark() const {
  if (counters_.missing == 0) return std::nullopt;
  return fmt::format(
      "this station is too slow: {} blocks missed, last values asked for again {} times",
      counters_.missing, counters_.requests);
}

std::string WatchModel::summary() const {
  return fmt::format("{}{}{}{}{} of them GOOD", samples_,
                     samples_ == 1 ? " sample of " : " samples of ", rows_.size(),
                     rows_.size() == 1 ? " channel, " : " channels, ", good());
}

}  // namespace fieldcast::cli
