// Runs a ConfigurationAgent on its own thread, and responds to the requests of engineers one after
// the other.
#pragma once

#include <condition_variable>
#include <deque>
#include <functional>
#include <mutex>
#include <string>
#include <thread>
#include <variant>

#include "bridge/configure/configuration_agent.hpp"
#include "bridge/dds/topics/configuration_message.hpp"

namespace fieldcast {

class ConfigurationService {
 public:
  static constexpr std::size_t kMostWaiting = 8;  // requests; more are refused
  static constexpr Duration kLook = std::chrono::seconds{1};

  // `respond` is called on the service's thread, as the ports are. A probe that runs must end
  // before this object is destroyed; its buses end it when they stop.
  ConfigurationService(const std::string& file, configure::ConfigurationAgent::Ports ports,
                       std::function<void(const ConfigurationMessage& reply)> respond);
  ~ConfigurationService() { close(); }
  ConfigurationService(const ConfigurationService&) = delete;
  ConfigurationService& operator=(const ConfigurationService&) = delete;

  // Why requests of now on are refused (refusal_of_requests()); empty: they are not.
  void refuse_for(std::string reason);
  // `fault`: why the request must be refused; empty: it need not. Any thread; never waits.
  void receive(ConfigurationMessage request, std::string subject, std::string fault);
  // The reload of the file has ended; `refusal` as ConfigurationAgent::reloaded().
  void reloaded(std::string refusal);
  void close();  // nothing is called after it returns; a second call has no effect

 private:
  struct Request {
    ConfigurationMessage message;
    std::string subject, fault;
  };
  struct Reload {
    std::string refusal;
  };
  // To a request without its text.
  struct Response {
    ConfigurationMessage message;
    configure::Outcome outcome;
  };
  using Task = std::variant<Request, Reload, Response>;
  void put(Task task);
  void run(const std::string& file, const configure::ConfigurationAgent::Ports& ports);
  // There is no agent, because of this error.
  void refuse(Task task, const std::string& error);
  void serve(configure::ConfigurationAgent& agent, Task task);
  void serve(configure::ConfigurationAgent& agent, Request request);
  void respond(ConfigurationMessage& message, const configure::Outcome& outcome);

  const std::function<void(const ConfigurationMessage& reply)> respond_;
  std::mutex mutex_;
  std::condition_variable changed_;
  std::deque<Task> tasks_;
  std::string refusal_ = "the bridge is starting";
  bool ending_ = false;
  std::thread thread_;  // last: it uses the members above
};

// Why requests are refused by this configuration; empty if they are not. `is_on_loopback`: every
// peer in the domain is on this machine.
[[nodiscard]] std::string refusal_of_requests(const BridgeSpec& spec, bool is_on_loopback);

}  // namespace fieldcast
