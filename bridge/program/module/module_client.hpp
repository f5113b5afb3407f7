// The module's side of a dial-in: authenticates, sends its number, and relays bytes between the
// bridge and a line. For a small computer in front of a PLC. One io thread; reconnects.
#pragma once

#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/steady_timer.hpp>
#include <functional>
#include <memory>
#include <string>

#include "bridge/net/tls.hpp"
#include "bridge/process/secret.hpp"
#include "bridge/program/module/relay_end.hpp"

namespace fieldcast::program {

struct ModuleOptions {
  std::string host;
  std::uint16_t port = 0;
  std::string number, prefix;
  bool tls = false;
  // a PEM file of the authority of the bridge's certificate; empty: the system's
  std::string authorities;
  TlsSpec own;                               // the module's certificate and key, if it has one
  Secret secret;                             // empty: no challenge is expected
  Duration again = std::chrono::seconds{2};  // pause between two connections
};

class ModuleClient : public std::enable_shared_from_this<ModuleClient> {
 public:
  // `open_line` opens the line for each connection, or returns the reason why it cannot; `say`
  // receives one human-readable line.
  using OpenLine = std::function<tl::expected<FileDescriptor, std::string>()>;
  ModuleClient(boost::asio::io_context& io, ModuleOptions options, OpenLine open_line,
               std::function<void(const std::string&)> say);

  void start();
  void stop();

 private:
  void dial();
  void connected(std::unique_ptr<ByteStream> bridge);
  void from_bridge(ByteView bytes);
  void tell_number(std::string_view challenge);
  void carry();
  void over(const std::string& reason);

  boost::asio::io_context& io_;
  const ModuleOptions options_;
  const OpenLine open_line_;
  const std::function<void(const std::string&)> say_;
  boost::asio::ip::tcp::resolver resolver_;
  boost::asio::ip::tcp::socket socket_;
  boost::asio::steady_timer timer_;
  std::unique_ptr<TlsClient> tls_;
  std::shared_ptr<RelayEnd> bridge_, line_;
  std::string greeting_;  // bytes received before the number was sent, or directly after it
  bool told_ = false, carried_ = false, stopped_ = false;
};

}  // namespace fieldcast::program
