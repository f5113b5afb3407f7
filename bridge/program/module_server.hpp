// Where serial-to-network modules dial in: lets in those that show what they must (ModuleGate),
// asks each for its device number and hands its socket to the bus of that number; a module without
// a bus stays here, to be programmed, until a bus of its number comes. A reload changes where it
// listens and how it asks; modules that are connected stay. Lives on the server's io thread.
#pragma once

#include <boost/asio/ip/tcp.hpp>
#include <map>
#include <memory>
#include <string>
#include <tl/expected.hpp>
#include <unordered_set>

#include "bridge/log/repeat_filter.hpp"
#include "bridge/net/listener.hpp"
#include "bridge/port/dial_in_registry.hpp"
#include "bridge/program/hooks.hpp"
#include "bridge/program/module_gate.hpp"
#include "bridge/program/silent_connections.hpp"
#include "bridge/program/tls_pipe.hpp"
#include "core/model/spec.hpp"

namespace fieldcast::program {

class ModuleServer {
 public:
  // Modules whose number is not known yet, in all and from one address (many may share it). One
  // more displaces the oldest.
  static constexpr std::size_t kMaxAsked = 256, kMaxAskedOfOne = 128;
  static constexpr std::size_t kMaxKept = 1024;  // modules without a bus

  ModuleServer(boost::asio::io_context& io, DialInRegistry& registry, const Hooks& hooks);
  ~ModuleServer();

  // Listens there from now on, and nowhere else. The error is one line: why nobody can dial in;
  // then it listens nowhere.
  [[nodiscard]] tl::expected<void, std::string> listen(const ModulesSpec& spec);
  [[nodiscard]] std::uint16_t port() const;  // listened at; 0: nowhere
  // Lets every module go.
  void close();

  // A module whose number no bus is there for any more. Of two of a number the newer one is kept.
  void keep(const std::string& number, ModuleConnection connection);
  // A kept module, for the bus that has come for it; an invalid socket when there is none, or
  // while it is leased: it goes to its bus when its lease ends.
  [[nodiscard]] ModuleConnection hand_over(const std::string& number);

  // A module without a bus, for a programming session: a descriptor of its socket, invalid when
  // there is none of this number. `revoked`: it dialled in anew, or the server closes.
  [[nodiscard]] FileDescriptor lease(const std::string& number,
                                     std::function<void(std::string reason)> revoked);
  void end_lease(const std::string& number, bool lost);

 private:
  class Arrival;
  class Kept;
  void came(boost::asio::ip::tcp::socket socket);
  void registered(const std::string& number, boost::asio::ip::tcp::socket socket,
                  const std::string& address);
  // Whether a module of this number is connected, wherever its socket is.
  [[nodiscard]] bool connected(const std::string& number) const;
  // What goes along with the socket of a new one.
  [[nodiscard]] std::shared_ptr<void> appear(const std::string& number);
  void drop_kept(const std::string& number);  // if there is one: the module dialled in anew
  void keep_new(const std::string& number, ModuleConnection connection, const std::string& address);
  void refused(const std::string& address, const std::string& reason);
  void displaced(const std::string& address);

  boost::asio::io_context& io_;
  ModulesSpec spec_;
  DialInRegistry& registry_;
  const Hooks& hooks_;
  std::unique_ptr<Listener> listener_;  // null: nowhere
  std::shared_ptr<ModuleGate> gate_;    // of spec_; null: it has never listened
  std::unordered_set<std::shared_ptr<Arrival>> arrivals_;
  SilentConnections silent_{kMaxAsked, kMaxAskedOfOne};  // those of arrivals_
  RepeatFilter displacements_;
  std::map<std::string, std::shared_ptr<Kept>> kept_;
  std::map<std::string, std::weak_ptr<void>> present_;  // expired: not connected any more
  std::unordered_set<std::shared_ptr<TlsPipe>> pipes_;
  bool closed_ = false;
};

}  // namespace fieldcast::program
