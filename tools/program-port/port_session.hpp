// Relays between the bridge's stream and the local port with the pure PortClient. Connects again
// after a loss if the options say so; the local port stays open. Runs on the io_context of main.
#pragma once

#include <boost/asio/io_context.hpp>
#include <boost/asio/steady_timer.hpp>
#include <memory>

#include "bridge/program/module/relay_end.hpp"
#include "core/program/port_client.hpp"
#include "core/program/reconnection.hpp"
#include "tools/program-port/bridge_dialer.hpp"
#include "tools/program-port/local_port.hpp"
#include "tools/program-port/port_report.hpp"
#include "tools/program-port/stop_requests.hpp"

namespace fieldcast::port {

struct PortOptions {
  BridgeOptions bridge;
  bool reconnect = false;
  program::PortClientRules rules;
};

class PortSession {
 public:
  // `report` must outlive the session.
  PortSession(boost::asio::io_context& io, PortOptions options, std::unique_ptr<LocalPort> port,
              PortReport& report);
  void start();
  [[nodiscard]] const program::PortEnd& end() const { return end_; }

 private:
  void stop();
  void connect();
  void connected(std::unique_ptr<ByteStream> stream);
  void tell(const program::PortClient::Event& event);
  void execute(const program::PortClient::ToBridge& what);
  void execute(const program::PortClient::ToProgram& what);
  void execute(const program::PortClient::SetTimer& what);
  void execute(const program::PortClient::Paired& what);
  void execute(const program::PortClient::Dropped& what);
  void execute(const program::PortClient::Finish& what);
  void open_terminal();
  void lost_port(const std::string& reason);
  void ended(const program::PortEnd& end);
  void connect_later(const program::Reconnection::Next& next);
  void check_line();
  void tick();
  void wind_up();
  void flush(Instant bridge_moved, Instant program_moved);
  void tell_last_bytes();

  boost::asio::io_context& io_;
  const PortOptions options_;
  const std::unique_ptr<LocalPort> port_;
  PortReport& report_;
  program::PortClient client_;
  program::Reconnection reconnection_;
  BridgeDialer dialer_;
  StopRequests stops_;
  boost::asio::steady_timer timer_, ticking_, limit_;
  std::shared_ptr<program::RelayEnd> bridge_, terminal_;
  const std::optional<program::LineSettings> untouched_;  // before any program has set them
  std::optional<program::LineSettings> settings_;         // as last seen
  unsigned ticks_ = 0;
  std::size_t last_bytes_ = 0;  // bytes waiting for the bridge at the end; 0: none
  program::PortEnd end_;
  std::optional<program::PortEnd> lost_;  // reason of an end that this computer causes
  bool awaits_program_ = false;           // connects when the program sends
  bool paired_ = false;                   // until the end of the pairing is reported
  bool over_ = false;
};

}  // namespace fieldcast::port
