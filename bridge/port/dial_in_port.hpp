// Port of a dial-in module: it is open while a module with the configured number is connected.
// Lives on its bus's io thread; modules arrive through the registry.
#pragma once

#include "bridge/port/dial_in_registry.hpp"
#include "bridge/port/stream_port.hpp"

namespace fieldcast {

class DialInPort final : public StreamPort {
 public:
  // The registry outlives the port.
  DialInPort(boost::asio::io_context& io, DialInPortSpec spec, DialInRegistry& registry);
  ~DialInPort() override;

  void retire() override;

 private:
  class Opening;
  // Without a module, the first opening ends in on_closed with that reason; later ones wait.
  std::shared_ptr<PortOpening> make_opening(PortListener& listener) override;

  boost::asio::io_context& io_;
  DialInPortSpec spec_;
  DialInRegistry& registry_;
  DialInRegistry::Id expectation_;
  bool told_ = false;  // the missing module was reported
};

}  // namespace fieldcast
