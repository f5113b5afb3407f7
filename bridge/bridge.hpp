// The running bridge: connects DDS and the buses, and routes commands and interests between them.
//
// Owns the io threads, the DdsLink and the bus runners. Call the functions on the main thread. DDS
// threads enter only through the handlers of the link.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <tl/expected.hpp>
#include <vector>

#include "bridge/service/service.hpp"
#include "core/model/spec.hpp"

namespace fieldcast {

class Bridge {
 public:
  Bridge();
  ~Bridge();
  Bridge(const Bridge&) = delete;
  Bridge& operator=(const Bridge&) = delete;

  // Joins the DDS domain and starts every bus. A missing port is not an error: its bus waits for
  // it. Fails with the reason of DDS, one line. With thousands of channels this lasts seconds:
  // `give_up` is called before each bus, and if it returns true, no further bus is started.
  [[nodiscard]] tl::expected<void, std::string> start(
      const BridgeSpec& spec, const std::function<bool()>& give_up = [] { return false; });

  // Restarts only the buses that differ; after an error nothing has changed. REQUIRES: started.
  struct Reloaded {
    // Programming sessions that the reload would end: "line/plc by anna (10.0.0.7:51234)". If not
    // empty, nothing was reloaded; try again later.
    std::vector<std::string> waits_for;
  };
  [[nodiscard]] tl::expected<Reloaded, std::string> reload(const BridgeSpec& wanted);

  void set_trace(bool on);

  // Last turn of each bus's io thread (BusRunner::last_turn).
  [[nodiscard]] std::vector<BusTurn> turns() const;

  // Responds to every pending command and disposes every instance, in less than two seconds.
  void stop();

  // For the thread that ends the process when the main thread hangs. busy_with() returns what the
  // main thread does. save() writes the pending data of the store, as far as the limit allows.
  [[nodiscard]] std::string busy_with() const;
  void save(Duration limit);

 private:
  struct State;
  std::unique_ptr<State> state_;
};

// "2 buses, DDS domain 0"
[[nodiscard]] std::string buses_text(const BridgeSpec& spec);

}  // namespace fieldcast
