#include "bridge/program/server.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <boost/asio/io_context.hpp>
#include <boost/asio/post.hpp>
#include <future>
#include <map>
#include <vector>

#include "bridge/base/io_thread.hpp"
#include "bridge/log/log.hpp"
#include "bridge/net/tls.hpp"
#include "bridge/program/engineer_server.hpp"
#include "bridge/program/module/module_gate.hpp"

namespace fieldcast::program {

namespace {

namespace asio = boost::asio;

constexpr std::chrono::milliseconds kStopLimit{2500};

}  // namespace

struct Server::State {
  State(Hooks given, DialInRegistry& where) : hooks(std::move(given)), registry(where) {}

  void open_modules();
  void close_modules();

  const Hooks hooks;
  DialInRegistry& registry;
  // Used by the main thread only.
  std::map<std::string, std::shared_ptr<BusRunner>> buses;
  IoThread io{"program"};                   // outlives the members below
  std::shared_ptr<ModuleServer> modules;    // set while the server is started or keeps modules
  std::shared_ptr<DeviceRegistry> devices;  // set while the server is started
  // The port of fieldcast-port first, then those of single devices.
  std::vector<std::unique_ptr<EngineerServer>> engineers;
};

// Modules whose bus ends are kept here, and move to a bus that is added for them.
void Server::State::open_modules() {
  modules = std::make_shared<ModuleServer>(io.context(), registry, hooks);
  const auto keep = [this, weak = std::weak_ptr(modules)](const std::string& number,
                                                          ModuleConnection connection) {
    asio::post(io.context(),
               [weak, number, kept = std::make_shared<ModuleConnection>(std::move(connection))] {
                 if (const auto server = weak.lock()) server->keep(number, std::move(*kept));
               });
  };
  const auto hand_over = [this](const std::string& number) {
    ModuleConnection connection;
    io.run([&] {
      if (modules) connection = modules->hand_over(number);
    });
    return connection;
  };
  registry.set_keeper({keep, hand_over});
}

void Server::State::close_modules() {
  if (!modules) return;
  registry.set_keeper({});
  io.run([&] { modules->close(); });
  io.run([] {});  // handlers cancelled by the close have run
  io.run([&] { modules.reset(); });
}

Server::Server(Hooks hooks, DialInRegistry& registry)
    : state_(std::make_unique<State>(std::move(hooks), registry)) {}
Server::~Server() { stop(); }

tl::expected<void, std::string> Server::start(const ProgramSpec& spec) {
  State& s = *state_;
  if (!spec.modules) s.close_modules();
  if (!spec.engineers && !spec.modules) return {};
  if (!s.modules && spec.modules) s.open_modules();
  tl::expected<void, std::string> listening;
  s.io.run([&] {
    if (spec.modules) listening = s.modules->listen(*spec.modules);
    s.devices = std::make_shared<DeviceRegistry>(s.io.context(), s.modules);
    for (const auto& [name, bus] : s.buses) s.devices->add(bus->spec(), bus);
    if (!spec.engineers || !listening) return;
    const auto listen = [&](const EngineerPortSpec* port) {
      if (!listening) return;
      s.engineers.push_back(std::make_unique<EngineerServer>(s.io.context(), *spec.engineers, port,
                                                             s.devices, s.hooks));
      listening = s.engineers.back()->listen();
    };
    listen(nullptr);
    for (const EngineerPortSpec& port : spec.engineers->ports) listen(&port);
  });
  if (!listening) stop(Modules::kKeep);
  return listening;
}

void Server::stop(Modules modules) {
  State& s = *state_;
  stop_engineers();
  if (modules == Modules::kLetGo) s.close_modules();
}

void Server::stop_engineers() {
  State& s = *state_;
  if (!s.devices) return;
  const auto gone = std::make_shared<std::promise<void>>();
  s.io.run([&] {
    if (s.engineers.empty()) return gone->set_value();
    const auto left = std::make_shared<std::size_t>(s.engineers.size());
    for (const auto& engineers : s.engineers)
      engineers->close("the bridge stops", [gone, left] {
        if (--*left == 0) gone->set_value();
      });
  });
  const auto closed = gone->get_future();
  if (closed.wait_for(kStopLimit) != std::future_status::ready) {
    log_warning("program", "a client does not disconnect");
    closed.wait();  // its connection uses the server
  }
  s.io.run([] {});  // handlers cancelled by the close have run
  s.io.run([&] {
    s.engineers.clear();
    s.devices.reset();
  });
}

std::vector<LeasedDevice> Server::leased() const {
  std::vector<LeasedDevice> all;
  if (!state_->devices) return all;
  state_->io.run([&] { all = state_->devices->leased(); });
  return all;
}

bool Server::end_session(const std::string& bus, const std::string& device,
                         const std::string& reason) {
  bool ended = false;
  state_->io.run([&] {
    for (const auto& engineers : state_->engineers)
      ended = engineers->end_session(bus, device, reason) || ended;
  });
  return ended;
}

void Server::add_bus(const BusSpec& bus, std::shared_ptr<BusRunner> runner) {
  if (state_->devices) state_->devices->add(bus, runner);
  state_->buses.insert_or_assign(bus.name, std::move(runner));
}

void Server::remove_bus(const std::string& bus) {
  if (state_->devices) state_->devices->remove(bus);
  state_->buses.erase(bus);
}

std::uint16_t Server::engineers_port() const { return engineers_port(0); }
std::uint16_t Server::engineers_port(std::size_t at) const {
  return at < state_->engineers.size() ? state_->engineers[at]->port() : std::uint16_t{0};
}
std::uint16_t Server::modules_port() const {
  return state_->modules ? state_->modules->port() : std::uint16_t{0};
}

namespace {

std::string address_text(const ListenSpec& listen) {
  const bool v6 = listen.host.find(':') != std::string::npos;
  return fmt::format("{}:{}", v6 ? '[' + listen.host + ']' : listen.host, listen.port);
}

std::string tls_text(const TlsSpec& tls) {
  if (tls.authority.empty()) return "TLS";
  return fmt::format("TLS with a certificate of {}{}", tls.authority,
                     tls.revoked.empty() ? "" : " that is not revoked");
}

std::string tls_of(const EngineersSpec& engineers) {
  if (engineers.tls.certificate.empty()) return "no TLS";
  return engineers.proof == LoginProof::kEither ? "TLS" : tls_text(engineers.tls);
}

std::string login_text(const EngineersSpec& engineers) {
  const bool far = !on_loopback(engineers.listen);
  switch (engineers.proof) {
    case LoginProof::kCertificate: return "the certificate is the login";
    case LoginProof::kBoth: return "a login with the certificate and the password of a user";
    default: break;
  }
  if (!far && engineers.login == LoginRule::kOffLoopback) return "no login on the loopback";
  return engineers.proof == LoginProof::kEither
             ? "a login with the certificate or the password of a user"
             : "a login with the password of a user";
}

// `why` begins with the path of the file.
AccessFault fault_of(const std::string& part, const TlsSpec& tls, const std::string& secrets,
                     const std::string& why) {
  const std::pair<const char*, const std::string&> files[] = {{".certificate", tls.certificate},
                                                              {".key", tls.key},
                                                              {".authority", tls.authority},
                                                              {".revoked", tls.revoked},
                                                              {".secrets", secrets}};
  AccessFault fault{part, fmt::format("{}: {}", part, why)};
  for (const auto& [key, path] : files) {
    if (!path.empty() && why.starts_with(path + ':')) fault.key = part + key;
  }
  return fault;
}

}  // namespace

std::string to_text(const ModulesSpec& modules) {
  std::vector<std::string> shown;
  if (!modules.tls.certificate.empty()) shown.push_back(tls_text(modules.tls));
  if (!modules.secrets.empty()) shown.push_back("the secret of " + modules.secrets);
  if (!modules.from.empty()) shown.push_back(fmt::format("from {}", fmt::join(modules.from, ", ")));
  const bool open =
      modules.tls.authority.empty() && modules.secrets.empty() && modules.from.empty();
  if (open)
    shown.emplace_back(
        on_loopback(modules.listen)
            ? "every program on this machine can claim to be any of them"
            : "security: none, every client that reaches the port can claim to be any of them");
  return fmt::format(
      "modules dial in at {}: {}; a second one of a number {}", address_text(modules.listen),
      fmt::join(shown, ", "),
      modules.second == SecondModule::kRefuse ? "is refused" : "takes the place of the first");
}

std::string to_text(const EngineersSpec& engineers, const EngineerPortSpec& port) {
  const EngineerRules rules = rules_of(engineers, &port);
  std::vector<std::string> shown{tls_of(engineers)};
  EngineersSpec always = engineers;
  always.login = LoginRule::kAlways;
  shown.push_back(rules.login_needed ? login_text(always) : "no login");
  if (!port.user.empty()) shown.push_back("user " + port.user + " alone");
  if (!port.from.empty()) shown.push_back(fmt::format("from {}", fmt::join(port.from, ", ")));
  if (port.without_security) shown.emplace_back("security: none, the bytes are not encrypted");
  return fmt::format("device {} is programmed at {} by {}: {}", port.device,
                     address_text(port.listen), port.raw ? "raw bytes" : "RFC 2217",
                     fmt::join(shown, ", "));
}

std::string to_text(const EngineersSpec& engineers) {
  return fmt::format("engineers connect at {}: {}, {}", address_text(engineers.listen),
                     tls_of(engineers), login_text(engineers));
}

std::optional<AccessFault> check_files(const ProgramSpec& program) {
  if (const auto& modules = program.modules) {
    if (const auto gate = ModuleGate::make(*modules); !gate)
      return fault_of("modules", modules->tls, modules->secrets, gate.error());
  }
  const auto& engineers = program.engineers;
  if (engineers && !engineers->tls.certificate.empty()) {
    if (const auto tls = TlsServer::make(engineers->tls); !tls)
      return fault_of("engineers", engineers->tls, {}, tls.error());
  }
  return std::nullopt;
}

}  // namespace fieldcast::program
