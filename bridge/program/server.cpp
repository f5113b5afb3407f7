#include "bridge/program/server.hpp"

#include <boost/asio/io_context.hpp>
#include <boost/asio/post.hpp>
#include <future>
#include <map>

#include "bridge/io_thread.hpp"
#include "bridge/log.hpp"
#include "bridge/program/engineer_desk.hpp"

namespace fieldcast::program {
namespace {

namespace asio = boost::asio;

constexpr std::chrono::milliseconds kStopLimit{2500};

}  // namespace

struct Server::State {
  State(Hooks given, DialInRegistry& where) : hooks(std::move(given)), registry(where) {}

  // Runs on the io thread and waits for it.
  template <typename Task>
  void run(Task task) {
    std::promise<void> done;
    asio::post(io.context(), [&] {
      task();
      done.set_value();
    });
    done.get_future().wait();
  }

  const Hooks hooks;
  DialInRegistry& registry;
  std::map<std::string, std::pair<BusSpec, std::shared_ptr<BusRunner>>> buses;  // of the main thread
  IoThread io{"program"};                                                       // outlives what follows
  std::shared_ptr<ModuleDesk> modules;
  std::shared_ptr<DeviceBook> devices;  // of a server that is started
  std::unique_ptr<EngineerDesk> engineers;
};

Server::Server(Hooks hooks, DialInRegistry& registry) : state_(std::make_unique<State>(std::move(hooks), registry)) {}
Server::~Server() { stop(); }

tl::expected<void, std::string> Server::start(const ProgramSpec& spec) {
  State& s = *state_;
  if (!spec.engineers && !spec.modules) return {};
  tl::expected<void, std::string> listening;
  s.run([&] {
    if (spec.modules) {
      s.modules = std::make_shared<ModuleDesk>(s.io.context(), *spec.modules, s.registry, s.hooks);
      listening = s.modules->listen();
    }
    s.devices = std::make_shared<DeviceBook>(s.io.context(), s.modules);
    for (const auto& [name, bus] : s.buses) s.devices->add(bus.first, bus.second);
    if (!spec.engineers || !listening) return;
    s.engineers = std::make_unique<EngineerDesk>(s.io.context(), *spec.engineers, s.devices, s.hooks);
    listening = s.engineers->listen();
  });
  if (!listening) stop();
  return listening;
}

void Server::stop() {
  State& s = *state_;
  if (!s.devices) return;
  const auto gone = std::make_shared<std::promise<void>>();
  s.run([&] {
    if (s.engineers) {
      s.engineers->close("the bridge stops", [gone] { gone->set_value(); });
    } else {
      gone->set_value();
    }
  });
  if (gone->get_future().wait_for(kStopLimit) != std::future_status::ready) log_warning("program", "a client does not let go");
  s.run([&] {
    if (s.modules) s.modules->close();
  });
  s.run([] {});  // what the closing cancelled has run
  s.run([&] {
    s.engineers.reset();
    s.devices.reset();
    s.modules.reset();
  });
}

void Server::add_bus(const BusSpec& bus, std::shared_ptr<BusRunner> runner) {
  if (state_->devices) state_->devices->add(bus, runner);
  state_->buses.insert_or_assign(bus.name, std::pair{bus, std::move(runner)});
}

void Server::remove_bus(const std::string& bus) {
  if (state_->devices) state_->devices->remove(bus);
  state_->buses.erase(bus);
}

std::uint16_t Server::engineers_port() const { return state_->engineers ? state_->engineers->port() : std::uint16_t{0}; }
std::uint16_t Server::modules_port() const { return state_->modules ? state_->modules->port() : std::uint16_t{0}; }

}  // namespace fieldcast::program
