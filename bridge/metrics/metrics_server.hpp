// Serves over HTTP, to every client that can connect, without login and TLS:
// - GET /metrics: the metrics
// - GET /healthz: "ok", or status 503 with the fault, for the supervisor of a container
//
// Owns an io thread of low priority. A client cannot delay a bus: the complete text is made first
// and then written without a lock. If the server cannot listen, it logs that once and retries.
#pragma once

#include <atomic>
#include <functional>
#include <memory>
#include <string>

#include "bridge/metrics/metrics_text.hpp"
#include "core/model/channel_kind.hpp"
#include "core/model/program_spec.hpp"

namespace fieldcast {

class MetricsServer {
 public:
  struct Limits {
    // One more connection closes the one that has been silent longest.
    std::size_t connections = 8;
    std::size_t header_bytes = 4096;
    // From the connection, or from the last response, to a complete header.
    Duration request = std::chrono::seconds{10};
    // To send a complete response.
    Duration response = std::chrono::seconds{10};
    Duration try_again = std::chrono::seconds{5};
  };
  // Returns the present metrics. Called on the server's thread; must not block.
  using Source = std::function<std::string(MetricsFormat)>;

  // Returns the fault that a restart of the bridge may repair; empty if the bridge is healthy.
  // Called on the server's thread; must not block.
  using Health = std::function<std::string()>;

  MetricsServer(const ListenSpec& listen, Source source, Health health, const Limits& limits);
  MetricsServer(const ListenSpec& listen, Source source, Health health)
      : MetricsServer(listen, std::move(source), std::move(health), Limits{}) {}
  ~MetricsServer();  // closes every connection; the source is not called afterwards
  MetricsServer(const MetricsServer&) = delete;
  MetricsServer& operator=(const MetricsServer&) = delete;

  // Returns the port, or 0 if it does not listen yet.
  [[nodiscard]] std::uint16_t port() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace fieldcast
