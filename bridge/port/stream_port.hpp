// Base of ports whose line is a stream of bytes. Each opening is a separate object, which gets a
// stream and forwards calls to it; a new type implements its opening. On its bus's io thread.
#pragma once

#include "bridge/port/dial_in_registry.hpp"
#include "bridge/port/stream.hpp"

namespace fieldcast {

// One opening of a port. Handlers share ownership; after the end they do nothing.
class PortOpening : public std::enable_shared_from_this<PortOpening> {
 public:
  PortOpening(boost::asio::io_context& io, PortListener& listener) : io_(io), listener_(listener) {}
  virtual ~PortOpening() = default;
  PortOpening(const PortOpening&) = delete;
  PortOpening& operator=(const PortOpening&) = delete;

  // Ends later in opened() or fail(), never inside this call.
  virtual void begin() = 0;
  void close();
  // Null until it is open.
  [[nodiscard]] Stream* stream() const { return stream_.get(); }

 protected:
  virtual void cancel() = 0;
  void opened(std::shared_ptr<Stream> stream);
  void fail(std::string reason, Cause cause);

  template <typename Opening>
  [[nodiscard]] std::shared_ptr<Opening> self_as() {
    return std::static_pointer_cast<Opening>(shared_from_this());
  }

  boost::asio::io_context& io_;
  PortListener& listener_;
  bool over_ = false;

 private:
  std::shared_ptr<Stream> stream_;
};

class StreamPort : public Port {
 public:
  void open(PortListener& listener) final;
  void write(ByteView bytes) final;
  void write_more(ByteView bytes) final;
  void poll() final;
  bool wait(Instant until, int wake) final;
  void watch() final;
  void close() final;
  FileDescriptor lease() final;
  void end_lease() final;

 protected:
  [[nodiscard]] virtual std::shared_ptr<PortOpening> make_opening(PortListener& listener) = 0;
  [[nodiscard]] Stream* stream() const { return opening_ ? opening_->stream() : nullptr; }

  std::shared_ptr<PortOpening> opening_;  // shared with pending handlers
};

// TCP client, for a Modbus TCP device or a serial server that forwards the bytes of a line; or the
// UDP socket of a device whose frames are datagrams.
class TcpPort final : public StreamPort {
 public:
  TcpPort(boost::asio::io_context& io, TcpPortSpec spec) : io_(io), spec_(std::move(spec)) {}
  ~TcpPort() override { close(); }

 private:
  std::shared_ptr<PortOpening> make_opening(PortListener& listener) override;

  boost::asio::io_context& io_;
  TcpPortSpec spec_;
};

// Port of a dial-in module: open while a module with the configured number is connected.
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
