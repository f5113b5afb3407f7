// A TLS stream of Asio and its handshake. Only for bridge/net.
#pragma once

#include <boost/asio/ssl/stream.hpp>
#include <functional>
#include <memory>

#include "bridge/net/tls.hpp"

namespace fieldcast::tls {

using Secure = boost::asio::ssl::stream<boost::asio::ip::tcp::socket>;

// Calls `done` once, with an error if the handshake fails or is not finished within `limit`.
void run_handshake(const std::shared_ptr<Secure>& stream,
                   boost::asio::ssl::stream_base::handshake_type side, Duration limit,
                   std::function<void(TlsResult)> done);

}  // namespace fieldcast::tls
