// Decides when all bridges have reported: nothing new for kQuietTime and a report of each site, or
// after kBridgeWait. Pure.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "core/base/time.hpp"
#include "tools/cli/domain/connection.hpp"

namespace fieldcast::cli {

class Listening {
 public:
  Listening(const Connection& connection, Instant began);

  // Something new arrived for this bus (with sites: "site:bus").
  void news(std::string_view bus, Instant now);

  [[nodiscard]] bool anybody() const { return anybody_; }
  // For a bus without a known site: whether any bridge has reported.
  [[nodiscard]] bool heard_site_of(std::string_view bus) const;
  // End of the wait without further news.
  [[nodiscard]] Instant over_at() const;
  [[nodiscard]] Instant last_news() const { return last_news_; }
  [[nodiscard]] std::vector<std::string> silent_sites() const;
  // "no bridge found in site south"; empty with one site, or if all have reported.
  [[nodiscard]] std::string silent_text() const;

 private:
  struct Site {
    std::string name;  // empty: the only one
    bool heard = false;
  };
  [[nodiscard]] static bool is_of(const Site& site, std::string_view bus);

  std::vector<Site> sites_;
  Instant began_, last_news_;
  bool anybody_ = false;
};

}  // namespace fieldcast::cli
