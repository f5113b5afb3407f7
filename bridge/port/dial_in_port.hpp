// A module that dials in: the port is open while one is connected that told the number. Lives on
// its bus's io thread; modules come through the registry.
#pragma once

#include "bridge/port/dial_in_registry.hpp"
#include "bridge/port/port.hpp"

namespace fieldcast {

class Connection;

class DialInPort final : public Port {
 public:
  // The registry outlives the port.
  DialInPort(boost::asio::io_context& io, DialInPortSpec spec, DialInRegistry& registry);
  ~DialInPort() override;
  DialInPort(const DialInPort&) = delete;
  DialInPort& operator=(const DialInPort&) = delete;

  // The first time without a module ends at once in on_closed, which says so; from then on it waits
  // for one, however long.
  void open(PortListener& listener) override;
  void write(ByteView bytes) override;
  void expect(std::uint32_t) override {}
  void poll() override;
  void close() override;
  void retire() override;
  FileDescriptor lend() override;
  void take_back() override;

 private:
  class Session;
  boost::asio::io_context& io_;
  DialInPortSpec spec_;
  DialInRegistry& registry_;
  DialInRegistry::Ticket expectation_;
  std::shared_ptr<Session> session_;  // shared with the handlers under way
  bool told_ = false;                 // that no module is there
};

}  // namespace fieldcast
