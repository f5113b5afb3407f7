#include "tools/cli/domain/listening.hpp"

#include <algorithm>

namespace fieldcast::cli {

Listening::Listening(const Connection& connection, Instant began)
    : began_(began), last_news_(began) {
  for (const DdsSite& site : connection.sites) sites_.push_back({site.name});
}

bool Listening::is_of(const Site& site, std::string_view bus) {
  return site.name.empty() || (bus.size() > site.name.size() && bus.starts_with(site.name) &&
                               bus[site.name.size()] == ':');
}

void Listening::news(std::string_view bus, Instant now) {
  anybody_ = true;
  last_news_ = now;
  for (Site& site : sites_) site.heard = site.heard || is_of(site, bus);
}

bool Listening::heard_site_of(std::string_view bus) const {
  const auto site =
      std::ranges::find_if(sites_, [&](const Site& each) { return is_of(each, bus); });
  return site == sites_.end() ? anybody_ : site->heard;
}

Instant Listening::over_at() const {
  const Instant quiet_at = last_news_ + kQuietTime;
  const bool all = std::ranges::all_of(sites_, [](const Site& site) { return site.heard; });
  return all ? quiet_at : std::max(began_ + kBridgeWait, anybody_ ? quiet_at : began_);
}

std::vector<std::string> Listening::silent_sites() const {
  std::vector<std::string> names;
  for (const Site& site : sites_) {
    if (!site.heard && sites_.size() > 1) names.push_back(site.name);
  }
  return names;
}

std::string Listening::silent_text() const {
  std::string text;
  for (const std::string& name : silent_sites())
    text += (text.empty() ? "no bridge found in site " : ", ") + name;
  return text;
}

}  // namespace fieldcast::cli
