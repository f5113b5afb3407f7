// The running bridge: DDS on one side, a runner for each bus on the other, commands and interests routed between them.
//
// Owns the io threads, the DdsLink and the runners. The functions are for the main thread; DDS threads enter through the link's
// handlers only.
#pragma once

#include <memory>
#include <string>
#include <tl/expected.hpp>

#include "core/model/spec.hpp"

namespace fieldcast {

class Bridge {
 public:
  Bridge();
  ~Bridge();  // stop()
  Bridge(const Bridge&) = delete;
  Bridge& operator=(const Bridge&) = delete;

  // Joins DDS and starts every bus; ports that are missing are waited for. The error is one line: what DDS refused.
  [[nodiscard]] tl::expected<void, std::string> start(const BridgeSpec& spec);

  // Restarts just the buses that differ. On an error everything runs as before. REQUIRES: started.
  [[nodiscard]] tl::expected<void, std::string> reload(const BridgeSpec& wanted);

  // The wire trace of every bus.
  void set_trace(bool on);

  // Every pending command is answered, every instance disposed. In under two seconds.
  void stop();

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace fieldcast
