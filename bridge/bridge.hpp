// The running bridge: DDS on one side, a runner for each bus on the other, commands and interests
// routed between them.
//
// Owns the io threads, the DdsLink and the runners. The functions are for the main thread; DDS
// threads enter through the link's handlers only.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <tl/expected.hpp>
#include <vector>

#include "bridge/service/standing_bus.hpp"
#include "core/model/spec.hpp"

namespace fieldcast {

class Bridge {
 public:
  Bridge();
  ~Bridge();  // stop()
  Bridge(const Bridge&) = delete;
  Bridge& operator=(const Bridge&) = delete;

  // Joins DDS and starts every bus; ports that are missing are waited for. The error is one line:
  // what DDS refused. With thousands of channels it takes seconds: `give_up` is asked before each
  // bus, and when it says true no further bus is started.
  [[nodiscard]] tl::expected<void, std::string> start(
      const BridgeSpec& spec, const std::function<bool()>& give_up = [] { return false; });

  // Restarts just the buses that differ. On an error everything runs as before. REQUIRES: started.
  struct Reloaded {
    // Sessions of engineers that the reload would end: "line/plc by anna (10.0.0.7:51234)". Then it
    // is not done, and is to be tried again. Empty: done.
    std::vector<std::string> waits_for;
  };
  [[nodiscard]] tl::expected<Reloaded, std::string> reload(const BridgeSpec& wanted);

  // The wire trace of every bus.
  void set_trace(bool on);

  // When the thread of each bus last turned (BusRunner::last_turn).
  [[nodiscard]] std::vector<BusTurn> turns() const;

  // Every pending command is answered, every instance disposed. In under two seconds.
  void stop();

  // For a thread that ends a process whose main thread hangs. busy_with(): what the main thread is
  // doing. save(): writes what the store was given, as far as the limit allows.
  [[nodiscard]] std::string busy_with() const;
  void save(Duration limit);

 private:
  struct State;
  std::unique_ptr<State> state_;
};

// "2 buses, DDS domain 0"
[[nodiscard]] std::string buses_text(const BridgeSpec& spec);

}  // namespace fieldcast
