// The station as a whole: what owns what, and in which order it starts and stops. Made, started and
// stopped on the main thread; its parts live on one io thread.
//
//     store (records, audit) -> io thread -> DDS, live model -> site, routes -> server -> listener
#pragma once

#include <memory>
#include <string>
#include <tl/expected.hpp>

#include "bridge/service/standing_bus.hpp"
#include "tools/station/configuration.hpp"

namespace fieldcast::web {

class WebStation {
 public:
  WebStation(StationSpec spec, std::string version);
  ~WebStation();  // stop()
  WebStation(const WebStation&) = delete;
  WebStation& operator=(const WebStation&) = delete;

  struct Fault {
    bool configuration = false;  // a file that is named there is of no use
    std::string what;            // one line
  };
  // Joins the domain and listens. Once.
  [[nodiscard]] tl::expected<void, Fault> start();
  // "http://127.0.0.1:8090/". REQUIRES: started.
  [[nodiscard]] std::string address() const;

  // Takes certificate and key from their files anew; the error is one line.
  [[nodiscard]] tl::expected<void, std::string> renew_certificate();

  // When the io thread last came round, for the watchdog; at least once a second.
  [[nodiscard]] std::vector<BusTurn> turns() const;

  // Pages are told to go, what waits for the store is written. A second call has no effect.
  void stop();
  [[nodiscard]] std::string busy_with() const;  // of a stop that hangs

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace fieldcast::web
