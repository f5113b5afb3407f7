// When a command that asks once may take it that all bridges have told what they have: nothing new
// came for kQuietTime, and each site of the connection was heard, or kBridgeWait is over. Pure.
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

  // Something new came of this bus (of a site: "site:bus").
  void news(std::string_view bus, Instant now);

  [[nodiscard]] bool anybody() const { return anybody_; }
  // Some bridge of this bus's site was heard; of a bus without a site of the connection: of any.
  [[nodiscard]] bool heard_site_of(std::string_view bus) const;
  // Then it is over, unless more news come; never later than kBridgeWait, but for who goes on
  // telling.
  [[nodiscard]] Instant over_at() const;
  [[nodiscard]] Instant last_news() const { return last_news_; }
  // Of several sites those that were not heard.
  [[nodiscard]] std::vector<std::string> silent_sites() const;
  // "no bridge found in site south": of several sites those that were not heard. Empty: none.
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
