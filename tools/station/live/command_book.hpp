// The commands of people that are under way, and the outcomes of the latest. Pure: `now` comes in.
// One owner, on the io thread.
//
// Each command has one outcome: its result, or why there is none. What comes for a command that is
// not under way any more is dropped.
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
#include "tools/station/live/command_sink.hpp"

namespace fieldcast::web {

class CommandBook {
 public:
  static constexpr std::size_t kMaxUnderWay = 256;
  static constexpr std::size_t kMaxOfUser = 64;  // under way
  static constexpr std::size_t kMaxKept = 1024;  // outcomes, the oldest go first
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

  // Why the user may not ask for one more now.
  [[nodiscard]] std::optional<Refusal> why_not(const std::string& user) const;
  // Its outcome is known at `deadline` at the latest.
  void add(Asked asked, Done done, Instant deadline);
  // It was sent: from here on its result has until `deadline`.
  void on_sent(std::uint64_t request_id, Instant deadline);
  [[nodiscard]] std::optional<Ended> on_fault(std::uint64_t request_id, StationFault fault);
  [[nodiscard]] std::optional<Ended> on_result(const StationResult& result);
  // One whose deadline has passed; to be called until there is none.
  [[nodiscard]] std::optional<Ended> take_expired(Instant now);

  [[nodiscard]] std::size_t under_way() const { return under_way_.size(); }
  // Of a command of this user: the outcome; "pending" while it is under way. Nothing: unknown, or
  // too long ago.
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
