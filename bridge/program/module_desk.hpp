// Where serial-to-network modules dial in: asks each for its device number and hands its socket to the bus of that number; a
// module that is nobody's bus stays here, to be programmed. Lives on the server's io thread.
#pragma once

#include <boost/asio/ip/tcp.hpp>
#include <map>
#include <memory>
#include <string>
#include <tl/expected.hpp>
#include <unordered_set>

#include "bridge/port/dial_in_registry.hpp"
#include "bridge/program/hooks.hpp"
#include "bridge/program/listener.hpp"
#include "core/model/spec.hpp"

namespace fieldcast::program {

class ModuleDesk {
 public:
  static constexpr std::size_t kMaxAsked = 64;   // modules whose number is not known yet; more are turned away
  static constexpr std::size_t kMaxKept = 1024;  // modules without a bus

  ModuleDesk(boost::asio::io_context& io, ModulesSpec spec, DialInRegistry& registry, const Hooks& hooks);
  ~ModuleDesk();

  // The error is one line: why nobody can dial in.
  [[nodiscard]] tl::expected<void, std::string> listen();
  [[nodiscard]] std::uint16_t port() const;  // listened at
  void close();

  // A module without a bus, for a programming session: a descriptor of its socket, invalid when there is none of this number.
  // `revoked`: it dialled in anew, or the desk closes.
  [[nodiscard]] FileDescriptor lend(const std::string& number, std::function<void(std::string reason)> revoked);
  void take_back(const std::string& number, bool lost);

 private:
  class Asked;
  class Kept;
  void came(boost::asio::ip::tcp::socket socket);
  void registered(const std::string& number, boost::asio::ip::tcp::socket socket, const std::string& address);
  void refused(const std::string& address, const std::string& reason);

  boost::asio::io_context& io_;
  const ModulesSpec spec_;
  DialInRegistry& registry_;
  const Hooks& hooks_;
  Listener listener_;
  std::unordered_set<std::shared_ptr<Asked>> asked_;
  std::map<std::string, std::shared_ptr<Kept>> kept_;
  bool closed_ = false;
};

}  // namespace fieldcast::program
