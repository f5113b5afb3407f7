// A module that dials in: the port is open while one is connected that told the number. Lives on
// its bus's io thread; modules come through the registry.
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
  // The first time without a module ends at once in on_closed, which says so; from then on it waits
  // for one, however long.
  std::shared_ptr<PortOpening> make_opening(PortListener& listener) override;

  boost::asio::io_context& io_;
  DialInPortSpec spec_;
  DialInRegistry& registry_;
  DialInRegistry::Id expectation_;
  bool told_ = false;  // that no module is there
};

}  // namespace fieldcast
