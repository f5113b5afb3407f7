// WebSocket clients of fieldcast-station: subscribe to everything and record arrival times, on one
// separate thread.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

namespace fieldcast::bench {

struct LiveReceived {
  std::uint64_t frames = 0, values = 0, bytes = 0, texts = 0;
  std::vector<double> spread_ms;  // sampled ages of all values, without the first frame
};

class LiveClients {
 public:
  explicit LiveClients(std::uint16_t port);
  ~LiveClients();
  LiveClients(const LiveClients&) = delete;
  LiveClients& operator=(const LiveClients&) = delete;

  // Returns the index of the connected client. Throws std::runtime_error.
  std::size_t connect();
  // Seconds from connect() until this many values arrived; 0 after `patience` seconds.
  [[nodiscard]] double first_data(std::size_t client, std::uint64_t values, double patience);
  void stop_reading(std::size_t client);
  void resume(std::size_t client);
  [[nodiscard]] double age(std::size_t client) const;

  void mark();  // starts a new measurement
  [[nodiscard]] LiveReceived received(std::size_t client) const;
  [[nodiscard]] bool is_open(std::size_t client) const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

// Result of a GET: body size and time. Throws std::runtime_error.
struct Fetched {
  std::size_t bytes = 0;
  double seconds = 0;
  unsigned status = 0;
};
[[nodiscard]] Fetched fetch(std::uint16_t port, const std::string& path);

}  // namespace fieldcast::bench
