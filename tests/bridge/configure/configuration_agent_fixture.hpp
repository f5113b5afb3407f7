// A configuration agent with a file of its own, at a fixed time; each test ends its probes.
#pragma once

#include <gtest/gtest.h>

#include <fstream>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "bridge/configure/configuration_agent.hpp"
#include "bridge/security/file_access.hpp"
#include "tests/bridge/security/scratch_folder.hpp"

namespace fieldcast::configure {

using nlohmann::json;

inline constexpr const char* kText = R"(bridge: b
configure: { allow: true }
buses:
  - name: line
    port: { tcp: "127.0.0.1:502" }
    protocol: modbus-tcp
    devices:
      - { name: d, address: 1, channels: [ { name: c, at: "holding:1", type: uint16 } ] }
)";

class ConfigurationAgentTest : public testing::Test {
 protected:
  ConfigurationAgentTest() {
    std::ofstream(file_) << kText;
    start();
  }

  void start() {
    agent_.emplace(file_, ConfigurationAgent::Ports{
                              .reload = [this] { ++reloads_; },
                              .qualities = [this] { return qualities_; },
                              .audit = [this](AuditEntry entry) { audit_.push_back(entry); },
                              .clock = [this] { return clock(); },
                              .probe =
                                  [this](const std::string& bus, DeviceProbe probe, auto done) {
                                    bus_ = bus;
                                    probe_.emplace(std::move(probe));
                                    probed_ = std::move(done);
                                    return bus == "line";
                                  }});
  }
  std::pair<unsigned, json> run(const std::string& operation, json request = json::object()) {
    request["operation"] = operation;
    if (!request.contains("who")) request["who"] = "anna";
    auto outcome = agent_->run(request.dump(), "", [this](Outcome late) { later_ = late; });
    if (!outcome) return {0, {}};
    return {outcome->status, json::parse(outcome->body)};
  }
  [[nodiscard]] UtcMapping clock() const { return {now_, {now_.time_since_epoch().count()}}; }
  std::pair<unsigned, json> deploy(const std::string& text) {
    return run("deploy", {{"text", text}, {"base", version_of(file())}, {"why", "a test"}});
  }
  [[nodiscard]] std::string file() const { return security::read_file(file_); }
  std::string state_of_last() { return run("versions").second[0]["state"]; }

  test::ScratchFolder scratch_;
  const std::string file_ = scratch_.path("b.yaml");
  const std::string more_ = std::string(kText) + "log: { level: debug }\n";
  Instant now_{std::chrono::hours{1}};
  int reloads_ = 0;
  std::optional<ChannelQualities> qualities_ = ChannelQualities{{"line/d/c", Quality::kGood}};
  std::vector<AuditEntry> audit_;
  std::string bus_;
  std::optional<DeviceProbe> probe_;
  ConfigurationAgent::Ports::Probed probed_;
  std::optional<Outcome> later_;
  std::optional<ConfigurationAgent> agent_;
};

}  // namespace fieldcast::configure
