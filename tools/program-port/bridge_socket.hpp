// Settings of the socket to the bridge.
#pragma once

#include <boost/asio/ip/tcp.hpp>

namespace fieldcast::port {

// Sends small packets immediately, and detects a peer that vanished without a message.
void tune_bridge_socket(boost::asio::ip::tcp::socket& socket);

}  // namespace fieldcast::port
