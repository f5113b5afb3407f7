#include "tools/program-port/bridge_dialer.hpp"

#include <fmt/format.h>

#include <boost/asio/connect.hpp>
#include <utility>

#include "bridge/base/clock.hpp"
#include "tools/program-port/bridge_socket.hpp"

namespace fieldcast::port {
namespace {

using boost::asio::ip::tcp;

constexpr std::chrono::seconds kConnectLimit{10};

}  // namespace

BridgeDialer::BridgeDialer(boost::asio::io_context& io, BridgeOptions options)
    : options_(std::move(options)), resolver_(io), socket_(io), limit_(io) {}

void BridgeDialer::cancel() {
  ++attempt_;
  limit_.cancel();
  resolver_.cancel();
  boost::system::error_code ignored;
  socket_.close(ignored);
}

void BridgeDialer::dial(std::function<void(TlsResult)> done) {
  done_ = std::move(done);
  const unsigned attempt = ++attempt_;
  limit_.expires_after(kConnectLimit);
  limit_.async_wait([this, attempt](boost::system::error_code cancelled) {
    if (!cancelled && attempt == attempt_) fail("no connection in time");
  });
  resolver_.async_resolve(
      options_.host, std::to_string(options_.port),
      [this, attempt](boost::system::error_code fault, const tcp::resolver::results_type& found) {
        if (attempt != attempt_) return;
        if (fault) return fail(fault.message());
        boost::asio::async_connect(socket_, found,
                                   [this, attempt, began = steady_now()](
                                       boost::system::error_code refused, const tcp::endpoint&) {
                                     if (attempt != attempt_) return;
                                     round_trip_ = steady_now() - began;
                                     if (refused) return fail(refused.message());
                                     connected(attempt);
                                   });
      });
}

void BridgeDialer::connected(unsigned attempt) {
  tune_bridge_socket(socket_);
  if (!options_.tls) return finish(socket_stream(std::move(socket_)));
  auto tls = TlsClient::make(options_.authorities, options_.own);
  if (!tls) return fail(tls.error());
  tls_ = std::move(*tls);
  tls_->shake_hands(std::move(socket_), options_.host, kConnectLimit,
                    [this, attempt](TlsResult stream) {
                      if (attempt != attempt_) return;
                      stream ? finish(std::move(stream)) : fail(stream.error());
                    });
}

void BridgeDialer::fail(const std::string& reason) {
  finish(tl::make_unexpected(fmt::format("{}:{}: {}", options_.host, options_.port, reason)));
}

void BridgeDialer::finish(TlsResult result) {
  cancel();
  std::exchange(done_, {})(std::move(result));
}

}  // namespace fieldcast::port
