// Captures of a bridge's buses, for local clients (capture_socket.hpp) and to configured files.
// Owns its thread; buses write to taps and never wait. Call it on the thread that changes the set
// of buses. Failures are only logged.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>

#include "bridge/capture/bus_capture.hpp"
#include "core/model/bus_spec.hpp"

namespace fieldcast {

class IoThread;

class CaptureService {
 public:
  static constexpr std::size_t kMaxClients = 16, kMaxRefused = 4;
  // Period of writing; a tap must hold the records of this time.
  static constexpr Duration kTurn = std::chrono::milliseconds{100};

  explicit CaptureService(const std::string& bridge);
  ~CaptureService();  // completes every file and stream within half a second
  CaptureService(const CaptureService&) = delete;
  CaptureService& operator=(const CaptureService&) = delete;

  // Pass the tap to the bus's runner before it starts.
  [[nodiscard]] std::shared_ptr<CaptureTap> add_bus(const BusSpec& bus);
  // Call after the runner stopped; its last frames are still written.
  void remove_bus(const std::string& name);
  void configure(const std::string& name, const std::optional<CaptureSpec>& spec);

 private:
  class Loop;
  void run(const std::function<void(const std::function<void()>& done)>& work);

  std::unique_ptr<IoThread> io_;
  std::shared_ptr<Loop> loop_;  // destroyed before its thread
};

}  // namespace fieldcast
