// Runs the bridge's bus engine on a port in this process, without DDS and configuration. Use it on
// one thread; the bus has its own.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <tl/expected.hpp>

#include "core/model/bus_spec.hpp"
#include "core/model/command.hpp"
#include "tools/cli/terminal/interrupt.hpp"

namespace fieldcast::cli {

class LineCapture;

class DirectBus {
 public:
  static constexpr Duration kOpenLimit = std::chrono::seconds{5};

  // `trace`: prints the bytes, one line each. `capture` must outlive the bus; it may be null.
  // REQUIRES: `bus` is valid as from the loader.
  DirectBus(const BusSpec& bus, bool trace, LineCapture* capture = nullptr);
  ~DirectBus();  // closes the port
  DirectBus(const DirectBus&) = delete;
  DirectBus& operator=(const DirectBus&) = delete;

  // The error is one human-readable line; empty if `interrupt` was raised.
  [[nodiscard]] tl::expected<void, std::string> open(const Interrupt& interrupt);
  // Waits for the result; empty if `interrupt` was raised. REQUIRES: open() was successful.
  [[nodiscard]] std::optional<CommandResult> run(fieldcast::Command command,
                                                 const Interrupt& interrupt);

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace fieldcast::cli
