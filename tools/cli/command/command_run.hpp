// Commands from here to their results: what `write` and `acquire` share.
#pragma once

#include <iosfwd>
#include <optional>
#include <string>
#include <vector>

#include "tools/cli/connection.hpp"
#include "tools/cli/domain_view.hpp"
#include "tools/cli/exit_code.hpp"
#include "tools/cli/model/catalogue.hpp"
#include "tools/cli/view/command_text.hpp"

namespace fieldcast::cli {

// One command on its way. `command` is not used when the outcome says already that it is not to be
// sent.
struct Errand {
  StationCommand command;
  Outcome outcome;
  [[nodiscard]] bool to_be_sent() const { return outcome.state == Outcome::State::kResult; }
};

// A write of one value to a channel.
struct WriteDetails {
  std::string type, unit;  // of the channel
  bool verify = false;     // read back
};
[[nodiscard]] Errand channel_write(const ChannelPath& path, Value value, WriteDetails details);

// For a command to an address `at` on a bus that no bridge announced. When only the device is
// unknown, the bridge refuses the command.
[[nodiscard]] Errand unknown_bus(ChannelPath path, const std::string& at, bool write,
                                 const Catalogue& catalogue);

class CommandRun {
 public:
  struct Options {
    bool json = false;
    // The command's lifespan; its result may take kResultGrace longer.
    Duration timeout = std::chrono::seconds{5};
  };
  // REQUIRES: the domain view lives longer.
  CommandRun(DomainView& domain, const Connection& connection, Options options, std::ostream& out,
             std::ostream& err);

  // Reads the catalogue until it holds every path, or until nothing new comes. For a path without a
  // channel it waits for all channels; with kDevice only until the device is there. False: no
  // bridge is there, or Ctrl-C; err says which.
  enum class Wanted : unsigned char { kChannels, kDevice };
  [[nodiscard]] bool learn(const std::vector<ChannelPath>& paths,
                           Wanted wanted = Wanted::kChannels);
  [[nodiscard]] const Catalogue& catalogue() const { return catalogue_; }

  // Sends, in this order and a bounded number at a time, and prints each outcome as it comes. The
  // code is that of the worst.
  [[nodiscard]] ExitCode execute(std::vector<Errand> errands);

  // After learn() was false.
  [[nodiscard]] ExitCode why_not() const;

 private:
  static constexpr std::size_t kAtATime = 16;
  static constexpr Duration kResultGrace = std::chrono::seconds{2};

  // Waits for the bridge of its bus for `wait` at most.
  [[nodiscard]] bool send(Errand& errand, Duration lifespan, Duration wait);
  std::optional<std::string> note(const DomainEvent& event);
  void print(const Outcome& outcome);

  DomainView& domain_;
  const Connection& connection_;
  Options options_;
  std::ostream& out_;
  std::ostream& err_;
  Catalogue catalogue_;
};

}  // namespace fieldcast::cli
