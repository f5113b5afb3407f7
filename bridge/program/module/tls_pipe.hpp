// Joins a TLS connection to a plain socket. One io thread.
#pragma once

#include <boost/asio/steady_timer.hpp>
#include <functional>
#include <memory>

#include "bridge/base/file_descriptor.hpp"
#include "bridge/program/module/relay_end.hpp"

namespace fieldcast::program {

// Relays a TLS connection to a plain socket, for a bus. Both ends close together. One io thread.
class TlsPipe : public std::enable_shared_from_this<TlsPipe> {
 public:
  // `socket` is the descriptor below the TLS stream, which owns it.
  TlsPipe(boost::asio::io_context& io, std::unique_ptr<ByteStream> tls, int socket);

  // The plain end, invalid without free descriptors. `over` is called once, unless closed earlier.
  [[nodiscard]] FileDescriptor start(std::function<void()> over);
  // Closes immediately; bytes in flight are lost.
  void close();

 private:
  void relay(std::unique_ptr<ByteStream> plain);
  void watch();
  void gone(RelayEnd& other);
  void finish();

  boost::asio::io_context& io_;
  const int socket_;
  std::shared_ptr<RelayEnd> tls_, plain_;
  boost::asio::steady_timer timer_;
  std::function<void()> over_;
  bool ending_ = false;
};

}  // namespace fieldcast::program
