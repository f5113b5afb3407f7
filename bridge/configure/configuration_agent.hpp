// The operations on the configuration of a bridge: read, check, deploy, confirm, rollback,
// versions, version, probe, scan. JSON in, JSON out. One thread at a time; owns the files
// (version_folder.hpp), and calls the bridge through its ports.
#pragma once

#include <functional>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <string_view>

#include "bridge/configure/draft_check.hpp"
#include "bridge/configure/version_folder.hpp"
#include "bridge/configure/watch.hpp"
#include "bridge/store/records/records.hpp"
#include "core/base/time.hpp"
#include "core/bus/command/device_probe.hpp"

namespace fieldcast::configure {

// {"status", "body"}: the status of HTTP, and the body of the response.
struct Outcome {
  unsigned status = 200;
  std::string body;  // JSON
};
// Gets the outcome of an operation that waits for a bus. Any thread.
using Later = std::function<void(Outcome outcome)>;

class ConfigurationAgent {
 public:
  static constexpr std::size_t kMostText = 2u << 20;  // bytes of a configuration
  static constexpr std::size_t kMostWhy = 256, kMostWho = 200;

  struct Ports {
    std::function<void()> reload;  // begins the reload of the file; reloaded() reports its end
    // Empty while the buses of the bridge change.
    std::function<std::optional<ChannelQualities>()> qualities;
    std::function<void(AuditEntry entry)> audit;
    std::function<UtcMapping()> clock;
    // Returns false if the bus does not run here. `done` is called once, on any thread, without
    // devices if another probe runs on this bus.
    using Probed = std::function<void(const std::vector<ProbedDevice>&, const UtcMapping&)>;
    std::function<bool(const std::string& bus, DeviceProbe probe, Probed done)> probe;
  };
  ConfigurationAgent(const std::string& file, Ports ports);

  // {"operation", "who", ...}. `subject`: of the requester's identity; may be empty. Empty: `later`
  // gets the outcome.
  [[nodiscard]] std::optional<Outcome> run(std::string_view request, const std::string& subject,
                                           const Later& later);

  // `refusal`: why the bridge did not load the file; empty if it did.
  void reloaded(const std::string& refusal);
  // Ends a watch whose time is over, and writes what a full disk refused. Call it once a second
  // while needs_look().
  void look();
  [[nodiscard]] bool needs_look() const { return is_watching() || folder_.is_unwritten(); }
  [[nodiscard]] bool is_watching() const { return watch_.has_value(); }

 private:
  struct Caller {
    std::string name;  // "anna (engineer station-1)"
    const Later& later;
  };
  using Tree = nlohmann::json;
  using Response = std::optional<Outcome>;
  using Operation = Response (ConfigurationAgent::*)(const Tree& request, const Caller& caller);
  struct Row {
    std::string_view name;
    Operation operation;
  };
  static const Row kRows[];

  Response read(const Tree& request, const Caller& caller);
  Response check(const Tree& request, const Caller& caller);
  Response deploy(const Tree& request, const Caller& caller);
  Response confirm(const Tree& request, const Caller& caller);
  Response rollback(const Tree& request, const Caller& caller);
  Response versions(const Tree& request, const Caller& caller);
  Response version(const Tree& request, const Caller& caller);
  Response probe(const Tree& request, const Caller& caller);
  Response scan(const Tree& request, const Caller& caller);

  // `base`: the version that was changed.
  Outcome deploy(const std::string& given, const std::string& base, const std::string& why,
                 const Caller& caller);
  // Replaces the file and begins the watch. REQUIRES: the text is valid.
  Outcome put(const std::string& text, std::string why, const Caller& caller);
  // Restores the file of before and ends the watch. Returns false if the file is not the watched
  // version any more: an administrator has changed it. Throws if it cannot be read or restored.
  [[nodiscard]] bool roll_back(const std::string& reason, const std::string& who);
  void end_watch(std::string state);  // also if the state cannot be written
  void note(const std::string& who, const std::string& what, const std::string& result);
  [[nodiscard]] Json watch_json() const;

  VersionFolder folder_;
  const Ports ports_;
  std::optional<Watch> watch_;
};

// Before the bridge starts: if a watch was interrupted and the file is invalid or made the bridge
// restart repeatedly, restores the file of before. Returns what was done, for the log; empty if
// nothing was.
[[nodiscard]] std::string recover_configuration(const std::string& file);

}  // namespace fieldcast::configure
