// Owns all parts of the station. Create, start and stop it on the main thread; its parts run on one
// io thread.
//
//     store (records, audit) -> io thread -> DDS, live model -> site, routes -> server -> listener
#pragma once

#include <memory>
#include <string>
#include <tl/expected.hpp>

#include "bridge/service/service.hpp"
#include "tools/station/settings/configuration.hpp"

namespace fieldcast::web {

class WebStation {
 public:
  WebStation(StationSpec spec, std::string version);
  ~WebStation();  // calls stop()
  WebStation(const WebStation&) = delete;
  WebStation& operator=(const WebStation&) = delete;

  struct Fault {
    bool configuration = false;  // a file named in the configuration is invalid
    std::string what;            // one line
  };
  // Joins the domain and listens. Call it once.
  [[nodiscard]] tl::expected<void, Fault> start();
  // "http://127.0.0.1:8090/". REQUIRES: started.
  [[nodiscard]] std::string address() const;

  [[nodiscard]] tl::expected<void, std::string> renew_certificate();

  // Last heartbeat of the io thread for the watchdog; at least once a second.
  [[nodiscard]] std::vector<BusTurn> turns() const;

  // Closes the pages and writes queued rows to the store. A second call has no effect.
  void stop();
  [[nodiscard]] std::string busy_with() const;  // component that delays the stop

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace fieldcast::web
