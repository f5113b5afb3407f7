// Accepts modules that dial in: admits those that authenticate (ModuleGate), requests their device
// numbers, and passes each socket to the bus of that number. A module without a bus stays here for
// programming. A reload changes addresses and rules; modules stay. On the server's io thread.
#pragma once

#include <boost/asio/ip/tcp.hpp>
#include <map>
#include <memory>
#include <string>
#include <tl/expected.hpp>
#include <unordered_set>
#include <vector>

#include "bridge/log/log_lines.hpp"
#include "bridge/net/byte_stream.hpp"
#include "bridge/port/dial_in_registry.hpp"
#include "bridge/program/module/hooks.hpp"
#include "bridge/program/module/module_gate.hpp"
#include "bridge/program/module/relay_end.hpp"
#include "bridge/program/module/tls_pipe.hpp"
#include "core/model/program_spec.hpp"

namespace fieldcast::program {

class ModuleServer {
 public:
  // Limits for modules whose number is not known yet, in total and from one address (many may share
  // it). A further module displaces the oldest.
  static constexpr std::size_t kMaxAsked = 256, kMaxAskedOfOne = 128;
  static constexpr std::size_t kMaxKept = 1024;  // modules without a bus

  ModuleServer(boost::asio::io_context& io, DialInRegistry& registry, const Hooks& hooks);
  ~ModuleServer();

  // Listens only at the addresses of `spec` from now on. Fails with one line.
  [[nodiscard]] tl::expected<void, std::string> listen(const ModulesSpec& spec);
  [[nodiscard]] std::uint16_t port() const;  // that it listens on; 0: none
  // Disconnects every module.
  void close();

  // Keeps a module whose bus was removed. Of two with the same number the newer one is kept.
  void keep(const std::string& number, ModuleConnection connection);
  // A kept module for the added bus; invalid if none or leased (it moves when its lease ends).
  [[nodiscard]] ModuleConnection hand_over(const std::string& number);

  // Leases a module without a bus: a descriptor of its socket, or an invalid one. `revoked` is
  // called when the module reconnects or the server closes.
  [[nodiscard]] FileDescriptor lease(const std::string& number,
                                     std::function<void(std::string reason)> revoked);
  void end_lease(const std::string& number, bool lost);

  // Numbers of the modules without a bus.
  [[nodiscard]] std::vector<std::string> kept() const;
  // Returns true if a module of this number is connected, regardless of the owner of its socket.
  [[nodiscard]] bool connected(const std::string& number) const;

 private:
  class Handshake;
  class Kept;
  void came(boost::asio::ip::tcp::socket socket);
  void registered(const std::string& number, boost::asio::ip::tcp::socket socket,
                  const std::string& address);
  // Returns a token that has the lifetime of the socket of a new module.
  [[nodiscard]] std::shared_ptr<void> appear(const std::string& number);
  // no effect if there is none; the module has reconnected
  void drop_kept(const std::string& number);
  void keep_new(const std::string& number, ModuleConnection connection, const std::string& address);
  void refused(const std::string& address, const std::string& reason);
  void displaced(const std::string& address);

  boost::asio::io_context& io_;
  ModulesSpec spec_;
  DialInRegistry& registry_;
  const Hooks& hooks_;
  std::unique_ptr<Listener> listener_;  // null: not listening
  std::shared_ptr<ModuleGate> gate_;    // of spec_; null: never listened
  std::unordered_set<std::shared_ptr<Handshake>> arrivals_;
  SilentConnections silent_{kMaxAsked, kMaxAskedOfOne};  // those of arrivals_
  RepeatFilter displacements_;
  std::map<std::string, std::shared_ptr<Kept>> kept_;
  std::map<std::string, std::weak_ptr<void>> present_;  // expired: not connected any more
  std::unordered_set<std::shared_ptr<TlsPipe>> pipes_;
  bool closed_ = false;
};

}  // namespace fieldcast::program
