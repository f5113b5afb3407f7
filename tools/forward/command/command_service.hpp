// Runs the commands of the centre, one after the other, on its own thread. Each request gets one
// response; a repeated one gets the same again. What was refused before it reached a bridge is
// checked again when it is repeated.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "bridge/base/worker.hpp"
#include "bridge/station/station.hpp"
#include "tools/forward/command/command_journal.hpp"
#include "tools/forward/command/command_request.hpp"
#include "tools/forward/outlet/outlet.hpp"

namespace fieldcast::forward {

struct CommandSpec {
  std::string user;  // of Sparkplug: of all commands
  std::vector<CommandRule> rules;
};

class CommandService {
 public:
  // Requests that wait; further ones are refused.
  static constexpr std::size_t kMaxWaiting = 64;

  // Writes the value; blocks for its result. `lifespan`: latest start from now.
  using Execute = std::function<StationOutcome(const CommandRequest& request, Duration lifespan)>;

  // `journal`: the path of its file. Throws StoreError.
  CommandService(CommandSpec spec, const std::string& journal, Execute execute);

  // Any thread; does not block.
  void on_request(CentreRequest request);
  // Waits for the present command. Waiting and further ones are refused.
  void close() { worker_.close(); }

 private:
  void refuse(const CentreRequest& request) const;
  void run(BoundedQueue<CentreRequest>& requests);
  [[nodiscard]] std::string response_to(const CentreRequest& request);

  const CommandSpec spec_;
  const Execute execute_;
  CommandJournal journal_;
  Worker<CentreRequest> worker_;  // last: it uses the members above
};

}  // namespace fieldcast::forward
