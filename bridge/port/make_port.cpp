#include "bridge/base/check.hpp"
#include "bridge/port/dial_in_port.hpp"
#include "bridge/port/port.hpp"
#include "bridge/port/serial_port.hpp"
#include "bridge/port/tcp_port.hpp"

namespace fieldcast {
namespace {

struct Maker {
  boost::asio::io_context& io;
  DialInRegistry* modules;

  std::unique_ptr<Port> operator()(const SerialPortSpec& spec) const {
    return std::make_unique<SerialPort>(io, spec);
  }
  std::unique_ptr<Port> operator()(const TcpPortSpec& spec) const {
    return std::make_unique<TcpPort>(io, spec);
  }
  std::unique_ptr<Port> operator()(const DialInPortSpec& spec) const {
    FIELDCAST_CHECK(modules != nullptr);
    return std::make_unique<DialInPort>(io, spec, *modules);
  }
};

}  // namespace

std::unique_ptr<Port> make_port(boost::asio::io_context& io, const PortSpec& spec,
                                DialInRegistry* modules) {
  return std::visit(Maker{io, modules}, spec);
}

}  // namespace fieldcast
