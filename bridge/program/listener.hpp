// Listening sockets of the programming server. Includes Asio.
#pragma once

#include <boost/asio/ip/tcp.hpp>
#include <string>
#include <tl/expected.hpp>

#include "core/model/spec.hpp"

namespace fieldcast::program {

// Opens, binds and listens; the error is one line: "cannot listen at 127.0.0.1:4950: Address already in use".
[[nodiscard]] tl::expected<void, std::string> listen_at(boost::asio::ip::tcp::acceptor& acceptor, const ListenSpec& spec);

// Of the peer: "10.0.0.7:51234"; "?" when it is gone.
[[nodiscard]] std::string address_of(const boost::asio::ip::tcp::socket& socket);

}  // namespace fieldcast::program
