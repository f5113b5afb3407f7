// The bus engine: everything one bus does, as on_event(event, now) -> actions. No thread, no clock,
// no I/O.
//
// The shell (BusRunner) executes the actions on one strand; tests execute them in virtual time.
#pragma once

#include <memory>

#include "core/bus/event.hpp"
#include "core/model/spec.hpp"
#include "core/model/status.hpp"

namespace fieldcast {

class BusEngine {
 public:
  // REQUIRES: spec is as the loader makes it (every protocol known, every address inside its area);
  // codec outlives the engine.
  explicit BusEngine(const BusSpec& spec, TextCodec& codec = plain_text_codec());
  ~BusEngine();
  BusEngine(const BusEngine&) = delete;
  BusEngine& operator=(const BusEngine&) = delete;

  // Appends what is to be done. `now` never goes back.
  void on_event(const BusEvent& event, Instant now, Actions& actions);

  // Reports cover the time since the one before; the shell asks once a second. Does not change what
  // the engine does.
  [[nodiscard]] BusReport bus_report(Instant now);
  [[nodiscard]] DeviceReport device_report(DeviceIndex device, Instant now) const;

  [[nodiscard]] ChannelReport channel_report(ChannelIndex channel, Instant now) const;

  // Characters that the answer under way lacks, at least; 0 when that is not known. The shell may
  // let them gather.
  [[nodiscard]] std::uint32_t missing() const;

  // An answer may be on its way.
  [[nodiscard]] bool exchanging() const;

  // While set, exchanges are described in Traced actions.
  void set_trace(bool on);

 private:
  struct State;
  std::unique_ptr<State> state_;
};

// For those whose time is not the wire's: executes every MakePlan among the actions at once; what
// follows from it is appended.
void make_plans(BusEngine& engine, Instant now, Actions& actions);

}  // namespace fieldcast
