// Runs one BusEngine: a port, a clock and an outlet around on_event(event, now) -> actions.
//
// The engine and the port live on the io thread given; the functions here may be called from any thread and only post to it.
#pragma once

#include <future>
#include <memory>
#include <vector>

#include "bridge/bus_outlet.hpp"
#include "core/bus/event.hpp"
#include "core/model/spec.hpp"

namespace boost::asio {
class io_context;
}

namespace fieldcast {

class BusRunner {
 public:
  // Commands that may wait for the io thread. More are refused; the engine's own queue has its own limit.
  static constexpr std::size_t kMaxWaiting = 1024;

  // The outlet must outlive the runner's stop(). REQUIRES: spec is as the loader makes it.
  BusRunner(boost::asio::io_context& io, const BusSpec& spec, BusOutlet& outlet);
  ~BusRunner();  // REQUIRES: stop() was waited for, or start() never called
  BusRunner(const BusRunner&) = delete;
  BusRunner& operator=(const BusRunner&) = delete;

  // Opens the port, again and again until it opens.
  void start();

  // False: too many wait (the caller answers kQueueFull). A command taken ends in exactly one BusOutlet::complete().
  [[nodiscard]] bool post(Command command);
  void post(std::vector<InterestChanged> interests);
  // Wire trace on stdout.
  void set_trace(bool on);

  // Answers every pending command with kShutdown, reports the bus as stopped and closes the port. Ready when nothing of this bus
  // will happen any more. Once.
  [[nodiscard]] std::future<void> stop();

 private:
  class Loop;
  std::shared_ptr<Loop> loop_;  // shared with the handlers under way
};

}  // namespace fieldcast
