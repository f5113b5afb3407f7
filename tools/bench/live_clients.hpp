// Clients of fieldcast-station's WebSocket, for benches: they subscribe to everything and note when
// what was acquired arrives. All on one thread of their own.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

namespace fieldcast::bench {

// What one client received since the last mark.
struct LiveReceived {
  std::uint64_t frames = 0, values = 0, bytes = 0, texts = 0;
  std::vector<double> ages_ms;    // of the newest value of each frame, when it arrived
  std::vector<double> spread_ms;  // a sample of all values' ages, the first frame left out
};

class LiveClients {
 public:
  explicit LiveClients(std::uint16_t port);
  ~LiveClients();
  LiveClients(const LiveClients&) = delete;
  LiveClients& operator=(const LiveClients&) = delete;

  // Connects one more, and waits until it is connected. Gives its number. Throws
  // std::runtime_error.
  std::size_t connect();
  void disconnect(std::size_t client);
  // Seconds from the begin of connect() until as many values had come; 0: never, after `patience`
  // seconds.
  [[nodiscard]] double first_data(std::size_t client, std::uint64_t values, double patience);
  // The client reads nothing any more, until resume().
  void stop_reading(std::size_t client);
  void resume(std::size_t client);
  // Of the newest value that it has received, by the clock of now; in seconds.
  [[nodiscard]] double age(std::size_t client) const;

  void mark();  // a new measurement begins
  [[nodiscard]] LiveReceived received(std::size_t client) const;
  [[nodiscard]] bool is_open(std::size_t client) const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

// GET of a path: the body's size in bytes and the seconds that it took. Throws std::runtime_error.
struct Fetched {
  std::size_t bytes = 0;
  double seconds = 0;
  unsigned status = 0;
};
[[nodiscard]] Fetched fetch(std::uint16_t port, const std::string& path);

// A port of the loopback that nobody listens at now.
[[nodiscard]] std::uint16_t free_port();

}  // namespace fieldcast::bench
