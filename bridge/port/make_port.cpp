#include "bridge/port/port.hpp"
#include "bridge/port/serial_port.hpp"
#include "bridge/port/tcp_port.hpp"

namespace fieldcast {

std::unique_ptr<Port> make_port(boost::asio::io_context& io, const PortSpec& spec) {
  if (const auto* serial = std::get_if<SerialPortSpec>(&spec)) return std::make_unique<SerialPort>(io, *serial);
  return std::make_unique<TcpPort>(io, std::get<TcpPortSpec>(spec));
}

}  // namespace fieldcast
