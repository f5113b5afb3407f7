// Requests the list of devices of a bridge with the pure ListClient. Runs on the io_context of
// main.
#pragma once

#include <boost/asio/io_context.hpp>
#include <boost/asio/steady_timer.hpp>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "bridge/program/module/relay_end.hpp"
#include "core/program/list_client.hpp"
#include "tools/program-port/bridge_dialer.hpp"

namespace fieldcast::port {

class ListSession {
 public:
  ListSession(boost::asio::io_context& io, const BridgeOptions& bridge, program::ListClient client);
  void start();
  // REQUIRES: start() was called and the io_context has run until its end.
  [[nodiscard]] const program::ListClient::Result& result() const { return *result_; }

 private:
  void connected(std::unique_ptr<ByteStream> stream);
  void fail(program::PortEnd end);
  void end(program::ListClient::Result result);

  const std::string place_;  // of the bridge, for messages
  program::ListClient client_;
  BridgeDialer dialer_;
  boost::asio::steady_timer limit_;
  std::shared_ptr<program::RelayEnd> bridge_;
  std::optional<program::ListClient::Result> result_;
};

// One line for each device, as text or as JSON.
[[nodiscard]] std::vector<std::string> lines_of(const program::DeviceList& list, bool json);

}  // namespace fieldcast::port
