// Pending commands of users and latest outcomes, one for each command. Pure; on the io thread.
#pragma once

#include <cstdint>
#include <deque>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <string_view>

#include "bridge/station/station.hpp"
#include "core/base/time.hpp"
#include "tools/station/live/client_message.hpp"

namespace fieldcast::web {

class PendingCommands {
 public:
  static constexpr std::size_t kMaxUnderWay = 256;
  static constexpr std::size_t kMaxOfUser = 64;  // pending
  static constexpr std::size_t kMaxKept = 1024;  // stored outcomes; the oldest are dropped first
  using Done = CommandSink::Done;

  struct Asked {
    std::uint64_t request_id = 0;
    Caller caller;
    std::string what;    // "write 21.5"
    std::string target;  // "bus/device/channel"
  };
  struct Ended {
    Asked asked;
    CommandOutcome outcome;
    Done done;
  };

  // Empty if the user may send a further command.
  [[nodiscard]] std::optional<Refusal> why_not(const std::string& user) const;
  void add(Asked asked, Done done, Instant deadline);
  void on_sent(std::uint64_t request_id, Instant deadline);
  [[nodiscard]] std::optional<Ended> on_fault(std::uint64_t request_id, StationFault fault);
  [[nodiscard]] std::optional<Ended> on_result(const StationResult& result);
  [[nodiscard]] std::optional<Ended> take_expired(Instant now);

  [[nodiscard]] std::size_t under_way() const { return under_way_.size(); }
  // "pending" while it has no outcome; empty if unknown or dropped.
  [[nodiscard]] std::optional<CommandOutcome> find(std::string_view user,
                                                   std::uint64_t request_id) const;

 private:
  struct Waiting {
    Asked asked;
    Done done;
    Instant deadline;
    bool sent = false;
  };
  [[nodiscard]] std::optional<Ended> end(std::uint64_t request_id, CommandOutcome outcome);

  std::map<std::uint64_t, Waiting> under_way_;
  std::map<std::string, std::size_t, std::less<>> of_user_;
  std::deque<CommandOutcome> kept_;
};

}  // namespace fieldcast::web
