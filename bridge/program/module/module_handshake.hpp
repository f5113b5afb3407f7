// Handshake of a connected module: TLS, its number, its proof, and the wait for an older connection
// of the same number that may be about to end. Ends in ModuleServer::registered() or refused().
// Runs on the server's io thread; handlers keep it alive, and do nothing after its end.
#pragma once

#include <array>
#include <boost/asio/steady_timer.hpp>

#include "bridge/program/module/module_server.hpp"

namespace fieldcast::program {

class ModuleServer::Handshake : public std::enable_shared_from_this<Handshake> {
 public:
  // A module that reconnects is often faster than the end of its old connection.
  static constexpr Duration kSecondWait = std::chrono::milliseconds{500};

  SilentConnections::Id id = 0;

  // The server must outlive it.
  Handshake(ModuleServer& server, std::shared_ptr<ModuleGate> gate,
            boost::asio::ip::tcp::socket socket, std::string address);

  void start();
  void close();

 private:
  void secured(TlsResult stream, int descriptor);
  void ask();
  void read();
  void follow(Registration::Outcome outcome);
  void numbered(const std::string& number);
  void wait_for_other(const std::string& number, Instant until);
  // Also sends the reason to the module.
  void refuse(const std::string& reason);
  void end(const std::string& reason);
  void leave();
  [[nodiscard]] bool send(ByteView bytes);

  ModuleServer& server_;
  const std::shared_ptr<ModuleGate> gate_;
  const SecondModule second_;
  boost::asio::ip::tcp::socket socket_;
  boost::asio::steady_timer timer_;
  Registration registration_;
  const Duration limit_;  // for TLS
  const std::string address_;
  std::string common_name_;              // of its certificate
  std::function<void()> cut_handshake_;  // set during the handshake
  bool number_known_ = false;
  bool over_ = false;
  std::array<std::uint8_t, 256> buffer_;
};

}  // namespace fieldcast::program
