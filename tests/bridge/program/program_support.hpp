// A programming server on ports that the system selects; the audit is kept for the test.
#pragma once

#include <gmock/gmock.h>

#include <condition_variable>
#include <memory>
#include <mutex>

#include "bridge/base/io_thread.hpp"
#include "bridge/bus/bus_runner.hpp"
#include "bridge/port/dial_in_registry.hpp"
#include "bridge/program/server.hpp"
#include "tests/bridge/support/recording_sink.hpp"
#include "tests/bridge/support/tcp_client.hpp"

namespace fieldcast::test {

// Frames of logins with the password `secret`, which is that of anna.
inline constexpr const char* kLoginOfAnna = "@@AU616e6e61:736563726574FEFF";
inline constexpr const char* kLoginOfBob = "@@AU626f62:736563726574FEFF";

class ServerFixture : public testing::Test {
 protected:
  ServerFixture() {
    spec.engineers.emplace().listen = {"127.0.0.1", 0};
    spec.modules.emplace().listen = {"127.0.0.1", 0};
  }

  void start() {
    const auto started = server.start(spec);
    ASSERT_TRUE(started) << started.error();
  }
  [[nodiscard]] TcpClient module(std::string_view registration) const {
    TcpClient made(server.modules_port());
    made.send(registration);
    return made;
  }
  [[nodiscard]] TcpClient engineer() const { return TcpClient(server.engineers_port()); }

  // Repeats the request until the device is registered.
  [[nodiscard]] static std::string pair(TcpClient& client, const std::string& request) {
    const auto deadline = std::chrono::steady_clock::now() + std::chrono::seconds{10};
    std::string reply;
    unsigned requests = 0;
    do {
      client.send("@@" + request + "FEFF");
      reply = client.receive("FEFF");
    } while (reply == "@@0001FEFF" && ++requests < 9 &&
             std::chrono::steady_clock::now() < deadline);
    return reply;
  }

  // Returns false if no audit line has this text within the limit.
  [[nodiscard]] bool audited(const std::string& text) {
    std::unique_lock lock(mutex);
    return changed.wait_for(lock, std::chrono::seconds{10}, [&] {
      return std::any_of(audit.begin(), audit.end(), [&](const auto& entry) {
        return entry.result.find(text) != std::string::npos;
      });
    });
  }

  program::Hooks hooks() {
    program::Hooks made;
    made.audit = [this](const program::Transmission& entry) {
      {
        const std::lock_guard lock(mutex);
        audit.push_back(entry);
      }
      changed.notify_all();
    };
    made.report = [this](const ProgramSessionReport& report) {
      const std::lock_guard lock(mutex);
      reports.push_back(report);
    };
    made.login = [](const std::string& user, const Secret& password, const std::string&,
                    const auto& done) {
      done({user == "anna" && password.text() == "secret", "wrong password"});
    };
    made.certified = [](const std::string& user, const std::string&, const auto& done) {
      done({user == "anna", "the role viewer may not program"});
    };
    return made;
  }

  ProgramSpec spec;
  std::mutex mutex;
  std::condition_variable changed;
  std::vector<program::Transmission> audit;
  std::vector<ProgramSessionReport> reports;
  DialInRegistry modules;
  program::Server server{hooks(), modules};
};

// Repeats the request, each in a new connection, until the module is registered.
inline std::string paired(std::uint16_t port, const std::string& request,
                          std::unique_ptr<TcpClient>& client) {
  const auto deadline = std::chrono::steady_clock::now() + std::chrono::seconds{10};
  std::string reply;
  do {
    client = std::make_unique<TcpClient>(port);
    client->send("@@" + request + "FEFF");
    reply = client->receive("FEFF");
  } while (reply == "@@0001FEFF" && std::chrono::steady_clock::now() < deadline);
  return reply;
}

}  // namespace fieldcast::test
