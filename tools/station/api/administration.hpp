// The station's counters in the Prometheus text format 0.0.4, and logins by token. Runs on the io
// thread.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "bridge/log/log_lines.hpp"
#include "bridge/store/records/records.hpp"
#include "bridge/store/users/user_table.hpp"
#include "core/access/login.hpp"
#include "tools/station/api/base/database.hpp"
#include "tools/station/notify/notifier.hpp"
#include "tools/station/record/recorder.hpp"
#include "tools/station/web/logins.hpp"
#include "tools/station/web/route_table.hpp"

namespace fieldcast::web {

struct Metric {
  const char* name;  // without the prefix "fieldcast_station_"
  bool counter;      // false: gauge
  const char* help;
  double value;
  std::string site{};  // its label; empty: none. Metrics of one name follow each other.
};
[[nodiscard]] std::string metrics_text(const std::vector<Metric>& metrics);

[[nodiscard]] std::vector<Metric> metrics_of(const Database* database, const Store* store,
                                             const Recorder* recorder);
// Of a null notifier: none.
[[nodiscard]] std::vector<Metric> metrics_of(const Notifier* notifier);

// Logs in by token from the store. Runs on the io thread and never blocks. Audits the token's name,
// never the token. A peer that sends wrong tokens must wait; the audit has the first attempt of
// each wait.
class Tokens {
 public:
  // `database` and `audit` must outlive this object.
  Tokens(Database& database, Audit& audit, std::function<UtcTime()> utc,
         std::function<Instant()> now)
      : database_(database), audit_(audit), utc_(std::move(utc)), now_(std::move(now)) {}
  Tokens(const Tokens&) = delete;
  Tokens& operator=(const Tokens&) = delete;

  // Calls `done` once on the io thread, immediately or later, even if this object was destroyed.
  void check(std::string token, const std::string& peer, std::function<void(LoginVerdict)> done);

  // Returns all tokens that have not expired; empty if the store cannot be read now.
  void list(std::function<void(std::optional<std::vector<Token>>)> done);

 private:
  struct Shared {
    LoginThrottle throttle;
    RepeatFilter throttled;  // by address_group() of the peer
  };
  Database& database_;
  Audit& audit_;
  const std::function<UtcTime()> utc_;
  const std::function<Instant()> now_;
  const std::shared_ptr<Shared> shared_ = std::make_shared<Shared>();
};

}  // namespace fieldcast::web
