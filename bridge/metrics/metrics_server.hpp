// Gives out the metrics by HTTP: GET /metrics, nothing else, to whoever reaches the address. There
// is no login and no TLS.
//
// Owns its io thread, of low priority, on which everything runs and the text is made. A client
// cannot delay a bus: the text is made first, whole, and then written without any lock. When the
// address cannot be listened at, that is logged once and tried again, like a database that is away:
// the buses run.
#pragma once

#include <atomic>
#include <functional>
#include <memory>
#include <string>

#include "bridge/metrics/metrics_text.hpp"
#include "core/model/spec.hpp"

namespace fieldcast {

class MetricsServer {
 public:
  struct Limits {
    // One more cuts the one that has been silent longest.
    std::size_t connections = 8;
    std::size_t header_bytes = 4096;
    // For a whole header: from the connection, or from the last response, on.
    Duration request = std::chrono::seconds{10};
    // Until the client has taken all of a response.
    Duration response = std::chrono::seconds{10};
    // Between two attempts to listen.
    Duration try_again = std::chrono::seconds{5};
  };
  // The text of now. Called on the server's thread; must not block.
  using Source = std::function<std::string(MetricsFormat)>;

  MetricsServer(const ListenSpec& listen, Source source, const Limits& limits);
  MetricsServer(const ListenSpec& listen, Source source)
      : MetricsServer(listen, std::move(source), Limits{}) {}
  ~MetricsServer();  // cuts every connection; the source is not called afterwards
  MetricsServer(const MetricsServer&) = delete;
  MetricsServer& operator=(const MetricsServer&) = delete;

  // Where it listens; 0: not yet.
  [[nodiscard]] std::uint16_t port() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace fieldcast
