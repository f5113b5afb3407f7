// A bus of this process alone: the bridge's own engine on a port, without DDS and without a
// configuration. Commands run one after the other; their results come back to the caller.
//
// Used on one thread; the bus has a thread of its own.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <tl/expected.hpp>

#include "core/model/command.hpp"
#include "core/model/spec.hpp"
#include "tools/cli/interrupt.hpp"

namespace fieldcast::cli {

class LineCapture;

class DirectBus {
 public:
  // How long a port may take to open.
  static constexpr Duration kOpenLimit = std::chrono::seconds{5};

  // `trace`: the bytes go to the standard output as they pass, a text line each. `capture` takes
  // them, too, and outlives the bus; it may be null. REQUIRES: `bus` is as the loader makes it.
  DirectBus(const BusSpec& bus, bool trace, LineCapture* capture = nullptr);
  ~DirectBus();  // closes the port
  DirectBus(const DirectBus&) = delete;
  DirectBus& operator=(const DirectBus&) = delete;

  // Waits until the port is open. The error says why it is not, a text line for people; it is empty
  // when `interrupt` was raised.
  [[nodiscard]] tl::expected<void, std::string> open(const Interrupt& interrupt);
  // Waits for the result. Nothing: `interrupt` was raised. REQUIRES: open() was successful.
  [[nodiscard]] std::optional<CommandResult> run(fieldcast::Command command,
                                                 const Interrupt& interrupt);

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace fieldcast::cli
