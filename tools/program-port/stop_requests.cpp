#include "tools/program-port/stop_requests.hpp"

#include <boost/asio/signal_set.hpp>
#include <csignal>

namespace fieldcast::port {

struct StopRequests::State : std::enable_shared_from_this<State> {
  State(boost::asio::io_context& io, std::function<void()> given)
      : signals(io, SIGINT, SIGTERM, SIGHUP), on_stop(std::move(given)) {}

  void wait() {
    signals.async_wait([self = shared_from_this()](boost::system::error_code fault, int) {
      if (fault || self->cancelled) return;
      self->on_stop();
      if (!self->cancelled) self->wait();
    });
  }

  boost::asio::signal_set signals;
  std::function<void()> on_stop;
  bool cancelled = false;
};

StopRequests::StopRequests(boost::asio::io_context& io, std::function<void()> on_stop)
    : state_(std::make_shared<State>(io, std::move(on_stop))) {
  state_->wait();
}
StopRequests::~StopRequests() { cancel(); }

void StopRequests::cancel() {
  state_->cancelled = true;
  state_->signals.cancel();
}

}  // namespace fieldcast::port
