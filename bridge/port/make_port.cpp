#include "bridge/check.hpp"
#include "bridge/port/dial_in_port.hpp"
#include "bridge/port/port.hpp"
#include "bridge/port/serial_port.hpp"
#include "bridge/port/tcp_port.hpp"

namespace fieldcast {

std::unique_ptr<Port> make_port(boost::asio::io_context& io, const PortSpec& spec,
                                DialInRegistry* modules) {
  if (const auto* serial = std::get_if<SerialPortSpec>(&spec))
    return std::make_unique<SerialPort>(io, *serial);
  if (const auto* tcp = std::get_if<TcpPortSpec>(&spec)) return std::make_unique<TcpPort>(io, *tcp);
  FIELDCAST_CHECK(modules != nullptr);
  return std::make_unique<DialInPort>(io, std::get<DialInPortSpec>(spec), *modules);
}

}  // namespace fieldcast
