// Requests to end the session: Ctrl-C and SIGTERM, on Windows also the end of the console, of the
// user's login and of the service. One instance at a time, on one io thread.
#pragma once

#include <boost/asio/io_context.hpp>
#include <functional>
#include <memory>

namespace fieldcast::port {

class StopRequests {
 public:
  // Calls `on_stop` for each request, on the io thread, until cancel().
  StopRequests(boost::asio::io_context& io, std::function<void()> on_stop);
  ~StopRequests();
  StopRequests(const StopRequests&) = delete;
  StopRequests& operator=(const StopRequests&) = delete;

  // Until then the io_context has work.
  void cancel();

 private:
  struct State;
  std::shared_ptr<State> state_;
};

}  // namespace fieldcast::port
