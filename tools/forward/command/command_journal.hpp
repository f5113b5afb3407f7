// The commands that were passed to a bridge, and their results, in a SQLite file: a repeated
// request gets the first result, also after a restart. Not thread-safe. All functions throw
// StoreError.
#pragma once

#include <memory>
#include <optional>
#include <string>

#include "bridge/store/sql/sql.hpp"
#include "core/base/time.hpp"

namespace fieldcast::forward {

class CommandJournal {
 public:
  // Results are kept for this time; a request lives for at most a minute.
  static constexpr Duration kKeep = std::chrono::hours{24};

  // Commands without a result get `unknown`: the process ended while they ran.
  CommandJournal(const std::string& path, const std::string& unknown);

  struct Entry {
    bool is_new = false;
    std::optional<std::string> response;  // of a repeated request that is complete
  };
  // Stores the request before it is passed to a bridge.
  [[nodiscard]] Entry begin(const std::string& user, const std::string& id, UtcTime now);
  void complete(const std::string& user, const std::string& id, const std::string& response);
  // The stored response of a request; empty if the request is not known or not complete.
  [[nodiscard]] std::optional<std::string> response(const std::string& user, const std::string& id);

 private:
  std::unique_ptr<SqlConnection> connection_;
};

}  // namespace fieldcast::forward
