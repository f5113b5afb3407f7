// Captures of a bridge's buses: for clients of the same machine (capture_socket.hpp) and into the
// files of the configuration. Owns its thread; the buses put what passes into taps and never wait.
//
// Its functions are for the thread that changes the set of buses. Nothing can fail: what cannot be
// written, or where nobody can ask, is said in the log.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>

#include "bridge/capture/capture_tap.hpp"
#include "core/model/spec.hpp"

namespace fieldcast {

class IoThread;

class CaptureService {
 public:
  static constexpr std::size_t kMaxClients = 16;
  // How often what came is written: what the taps must hold.
  static constexpr Duration kTurn = std::chrono::milliseconds{100};

  explicit CaptureService(const std::string& bridge);
  ~CaptureService();  // every file and stream ends whole, as far as half a second allows
  CaptureService(const CaptureService&) = delete;
  CaptureService& operator=(const CaptureService&) = delete;

  // The tap is for the bus's runner, before it starts.
  [[nodiscard]] std::shared_ptr<CaptureTap> add_bus(const BusSpec& bus);
  // After the runner stopped: its last frames are still written.
  void remove_bus(const std::string& name);
  // The configuration says something else for a bus that runs on.
  void configure(const std::string& name, const std::optional<CaptureSpec>& spec);

 private:
  class Loop;
  void run(const std::function<void(const std::function<void()>& done)>& work);

  std::unique_ptr<IoThread> io_;
  std::shared_ptr<Loop> loop_;  // ends before its thread
};

}  // namespace fieldcast
