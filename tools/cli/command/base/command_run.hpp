// Sends commands and waits for their results; steps that commands share.
#pragma once

#include <functional>
#include <iosfwd>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "bridge/store/sql/sql.hpp"
#include "config/loader/loader.hpp"
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

// A command for `target` of the device of `path`, not sent yet; its text is `named` in the outcome.
[[nodiscard]] Errand errand_for(const ChannelPath& path, Operation operation, Target target,
                                const std::string& named);

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
  CommandRun(DomainView& domain, const Connection& connection, Options options, const Streams& to);

  // Reads the catalogue until it has every path, or nothing new arrives. A path without a channel
  // needs all channels, with kDevice only the device. False without a bridge or after Ctrl-C; `err`
  // has the reason.
  enum class Wanted : unsigned char { kChannels, kDevice };
  [[nodiscard]] bool learn(const std::vector<ChannelPath>& paths,
                           Wanted wanted = Wanted::kChannels);
  [[nodiscard]] const Catalogue& catalogue() const { return catalogue_; }

  // Sends in order, at most kAtATime in flight, and prints each outcome. Returns the worst code.
  [[nodiscard]] ExitCode execute(std::vector<Errand> errands);

  [[nodiscard]] ExitCode why_not() const;

 private:
  static constexpr std::size_t kAtATime = 16;
  static constexpr Duration kResultGrace = std::chrono::seconds{2};

  // Waits at most kBridgeWait for the bridge of the bus, but only once for a bus without one.
  [[nodiscard]] bool send(Errand& errand, Duration lifespan);
  std::optional<std::string> note(const DomainEvent& event);
  void print(const Outcome& outcome);

  DomainView& domain_;
  const Connection& connection_;
  Options options_;
  const Streams to_;
  Catalogue catalogue_;
  std::set<std::string> unserved_;  // buses for which the last send() found no bridge
};

// How commands begin. Each function creates the Interrupt before DDS starts threads.
template <typename Options>
using DomainFunction = ExitCode (*)(const Options& options, const Connection& connection,
                                    Interrupt& interrupt, const Streams& to);
using InDomain = std::function<ExitCode(const Connection& connection, Interrupt& interrupt)>;

[[nodiscard]] ExitCode in_domain(const ConnectionOptions& options, const Streams& to,
                                 const InDomain& command);

template <typename Options>
[[nodiscard]] RunCommand<Options> in_domain(DomainFunction<Options> run) {
  return [run](const Options& options, const Streams& to) {
    return in_domain(options.connection, to,
                     [&](const Connection& connection, Interrupt& interrupt) {
                       return run(options, connection, interrupt, to);
                     });
  };
}

// A command that checks for signals itself.
template <typename Options>
[[nodiscard]] RunCommand<Options> interruptible(ExitCode (*run)(const Options& options,
                                                                const Interrupt& interrupt,
                                                                const Streams& to)) {
  return [run](const Options& options, const Streams& to) {
    const Interrupt interrupt;
    return run(options, interrupt, to);
  };
}

// A command that a signal may end at any time.
template <typename Options>
[[nodiscard]] RunCommand<Options> ends_at_once(ExitCode (*run)(const Options& options,
                                                               const Streams& to)) {
  return [run](const Options& options, const Streams& to) {
    const EndAtOnce end;
    return run(options, to);
  };
}

using OnReport = std::function<bool(const DomainEvent& event, const Listening& listening)>;

// Receives reports until every bridge has reported, or for `time`.
[[nodiscard]] Listening receive_reports(DomainView& domain, const Connection& connection,
                                        std::optional<Duration> time, const Streams& to,
                                        const OnReport& on_event);

// After receive_reports(): prints the sites without a bridge. If there is nothing to show, prints
// the reason and returns the exit code. `any`: a bridge has reported.
[[nodiscard]] std::optional<ExitCode> no_reports(std::string_view command, const DomainView& domain,
                                                 const Connection& connection,
                                                 const Listening& listening, bool any,
                                                 std::ostream& err);

[[nodiscard]] std::optional<BridgeSpec> load_configuration(
    const std::string& path, std::ostream& err,
    const config::LoadOptions& options = config::default_options());

// Opens the store for `command`. Returns kUsage if the source is invalid. Throws StoreError.
[[nodiscard]] ExitCode in_store(const StoreSource& source, std::ostream& err, IfMissing missing,
                                const std::function<ExitCode(SqlConnection& store)>& command);

// Flushes the output. Returns kTrouble if it is incomplete, kOk if it has records; else kNothing
// after `nothing` was printed.
[[nodiscard]] ExitCode end_of_records(const Streams& to, std::size_t records,
                                      std::string_view nothing);

}  // namespace fieldcast::cli
