// Sends commands and waits for their results, for `write` and `acquire`.
#pragma once

#include <functional>
#include <iosfwd>
#include <optional>
#include <string>
#include <vector>

#include "tools/cli/command/base/command.hpp"
#include "tools/cli/domain/connection.hpp"
#include "tools/cli/domain/domain_view.hpp"
#include "tools/cli/model/command_text.hpp"
#include "tools/cli/model/watch_model.hpp"
#include "tools/cli/terminal/interrupt.hpp"
#include "tools/cli/text/output.hpp"

namespace fieldcast::cli {

// If the outcome is already known, `command` is not sent.
struct Errand {
  StationCommand command;
  Outcome outcome;
  [[nodiscard]] bool to_be_sent() const { return outcome.state == Outcome::State::kResult; }
};

struct WriteDetails {
  std::string type, unit;  // of the channel
  bool verify = false;     // read back
};
[[nodiscard]] Errand channel_write(const ChannelPath& path, Value value, WriteDetails details);

// For an address `at` on a bus that no bridge announced. A bridge refuses an unknown device itself.
[[nodiscard]] Errand unknown_bus(ChannelPath path, const std::string& at, bool write,
                                 const Catalogue& catalogue);

class CommandRun {
 public:
  struct Options {
    bool json = false;
    // Lifespan of a command; its result may arrive up to kResultGrace later.
    Duration timeout = std::chrono::seconds{5};
  };
  // REQUIRES: the references outlive this object.
  CommandRun(DomainView& domain, const Connection& connection, Options options, std::ostream& out,
             std::ostream& err);

  // Reads the catalogue until it has every path, or nothing new arrives. A path without a channel
  // needs all channels, with kDevice only the device. False without a bridge or after Ctrl-C; `err`
  // has the reason.
  enum class Wanted : unsigned char { kChannels, kDevice };
  [[nodiscard]] bool learn(const std::vector<ChannelPath>& paths,
                           Wanted wanted = Wanted::kChannels);
  [[nodiscard]] const Catalogue& catalogue() const { return catalogue_; }

  // Sends in order, at most kAtATime in flight, and prints each outcome. Returns the worst code.
  [[nodiscard]] ExitCode execute(std::vector<Errand> errands);

  // Exit code after learn() returned false.
  [[nodiscard]] ExitCode why_not() const;

 private:
  static constexpr std::size_t kAtATime = 16;
  static constexpr Duration kResultGrace = std::chrono::seconds{2};

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

// Runs a command in a DDS domain, with signals blocked before DDS starts threads. Main thread.

using DomainCommand = std::function<ExitCode(const Connection& connection, Interrupt& interrupt)>;

// kUsage if the configuration file has faults.
[[nodiscard]] ExitCode in_domain(const ConnectionOptions& options, const Streams& streams,
                                 const DomainCommand& command);

}  // namespace fieldcast::cli
