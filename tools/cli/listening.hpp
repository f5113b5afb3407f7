// Decides when all bridges have reported: nothing new for kQuietTime and each site of the
// connection has reported, or kBridgeWait has passed. Pure.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "core/base/time.hpp"
#include "tools/cli/connection.hpp"

namespace fieldcast::cli {

class Listening {
 public:
  Listening(const Connection& connection, Instant began);

  // Something new arrived for this bus (with sites: "site:bus").
  void news(std::string_view bus, Instant now);

  [[nodiscard]] bool anybody() const { return anybody_; }
  // Returns whether a bridge of the bus's site has reported; for a bus without a known site, any
  // bridge.
  [[nodiscard]] bool heard_site_of(std::string_view bus) const;
  // Time at which the wait ends without further news. At most kBridgeWait after the start, unless
  // news continue.
  [[nodiscard]] Instant over_at() const;
  [[nodiscard]] Instant last_news() const { return last_news_; }
  // Sites without a report, if there are several.
  [[nodiscard]] std::vector<std::string> silent_sites() const;
  // "no bridge found in site south": names sites without a report, if there are several. Empty:
  // none.
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
