#include "tools/program-port/bridge_socket.hpp"

#include "bridge/port/stream.hpp"
#include "bridge/program/module/relay_end.hpp"

namespace fieldcast::port {

void tune_bridge_socket(boost::asio::ip::tcp::socket& socket) {
  tune_socket(socket.native_handle(), program::kTunnelPatience);
}

}  // namespace fieldcast::port
