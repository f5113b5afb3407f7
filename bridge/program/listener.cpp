#include "bridge/program/listener.hpp"

#include <fmt/format.h>

#include <boost/asio/ip/v6_only.hpp>

namespace fieldcast::program {

using boost::asio::ip::tcp;

tl::expected<void, std::string> listen_at(tcp::acceptor& acceptor, const ListenSpec& spec) {
  boost::system::error_code fault;
  const auto address = boost::asio::ip::make_address(spec.host, fault);
  const tcp::endpoint endpoint(address, spec.port);
  if (!fault) acceptor.open(endpoint.protocol(), fault);
  if (!fault) acceptor.set_option(tcp::acceptor::reuse_address(true), fault);
  if (!fault) acceptor.bind(endpoint, fault);
  if (!fault) acceptor.listen(boost::asio::socket_base::max_listen_connections, fault);
  if (!fault) return {};
  boost::system::error_code ignored;
  acceptor.close(ignored);
  return tl::make_unexpected(fmt::format("cannot listen at {}:{}: {}", spec.host, spec.port, fault.message()));
}

std::string address_of(const tcp::socket& socket) {
  boost::system::error_code fault;
  const auto peer = socket.remote_endpoint(fault);
  if (fault) return "?";
  const std::string address = peer.address().to_string();
  return fmt::format("{}:{}", peer.address().is_v6() ? '[' + address + ']' : address, peer.port());
}

}  // namespace fieldcast::program
