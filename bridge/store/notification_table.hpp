// The notifications of a station: the durable queue, and what was sent about each alarm. Everything
// throws StoreError. One owner.
#pragma once

#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "bridge/store/records/notification_records.hpp"
#include "bridge/store/sql/sql.hpp"

namespace fieldcast {

class NotificationTable {
 public:
  // Ended messages are kept for this time, so that the page shows them.
  static constexpr Duration kKept = std::chrono::hours{7 * 24};
  // Progress of alarms that were closed longer ago is removed.
  static constexpr Duration kKeptProgress = std::chrono::hours{60 * 24};
  // Between two attempts for a message.
  static constexpr Duration kLongestPause = std::chrono::minutes{10};

  explicit NotificationTable(SqlConnection& connection) : connection_(connection) {}

  [[nodiscard]] std::vector<NotifyProgress> progress();
  [[nodiscard]] std::vector<NotifyWindow> windows();
  // Each replaces its previous row.
  void put(const NotifyProgress& progress);
  void put(const NotifyWindow& window);  // one without a start is removed

  // A message with a known id is ignored.
  void put(const Notification& message);
  // Ends the oldest waiting messages beyond `most` as "dropped". Returns their number.
  [[nodiscard]] std::uint64_t drop_oldest(std::uint64_t most, UtcTime now);
  // Ends waiting messages made before `oldest` as "expired". Returns their number.
  [[nodiscard]] std::uint64_t expire(UtcTime oldest, UtcTime now);
  // The waiting message of the target that is due for the longest time; empty if none is due. One
  // that would wait for more than kLongestPause is due: the clock was set back.
  [[nodiscard]] std::optional<QueuedNotification> next(const std::string& target, UtcTime now);
  void sent(const std::string& id, UtcTime now);
  void failed(const std::string& id, const std::string& error, UtcTime next_at);
  [[nodiscard]] std::uint64_t waiting();
  // Newest first; without texts.
  [[nodiscard]] std::vector<QueuedNotification> newest(std::int64_t limit);
  void remove_old(UtcTime now);

 private:
  SqlConnection& connection_;
};

}  // namespace fieldcast
