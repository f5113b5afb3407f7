#include "bridge/configure/configuration_agent.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <cerrno>
#include <filesystem>
#include <fstream>
#include <future>
#include <map>
#include <nlohmann/json.hpp>

#include "bridge/configure/configuration_service.hpp"
#include "bridge/security/file_access.hpp"
#include "tests/bridge/security/scratch_folder.hpp"
#include "tests/support/full_disk.hpp"

namespace fieldcast::configure {
namespace {

using namespace std::chrono_literals;
using nlohmann::json;
using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

constexpr const char* kText = R"(bridge: b
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
  Instant now_{1h};
  int reloads_ = 0;
  std::optional<ChannelQualities> qualities_ = ChannelQualities{{"line/d/c", Quality::kGood}};
  std::vector<AuditEntry> audit_;
  std::string bus_;
  std::optional<DeviceProbe> probe_;
  ConfigurationAgent::Ports::Probed probed_;
  std::optional<Outcome> later_;
  std::optional<ConfigurationAgent> agent_;
};

TEST_F(ConfigurationAgentTest, DeploysWatchesAndKeeps) {
  const auto [status, body] = deploy(more_);
  EXPECT_EQ(status, 200u) << body;
  EXPECT_EQ(file(), more_);
  EXPECT_EQ(reloads_, 1);
  EXPECT_EQ(run("read").second["watch"]["state"], "reloading");
  agent_->reloaded("");
  EXPECT_EQ(run("read").second["watch"]["state"], "watching");
  now_ += 30s;
  agent_->look();
  EXPECT_FALSE(agent_->is_watching());
  EXPECT_THAT(state_of_last(), HasSubstr("kept"));
  EXPECT_EQ(audit_.size(), 2u);
  EXPECT_EQ(audit_[0].who, "anna");
  EXPECT_EQ(audit_[0].what, "configuration: deploy");
}

TEST_F(ConfigurationAgentTest, RollsBackIfChannelsTurnBad) {
  ASSERT_EQ(deploy(more_).first, 200u);
  agent_->reloaded("");
  qualities_->at("line/d/c") = Quality::kBadNoResponse;
  now_ += 30s;
  agent_->look();
  EXPECT_EQ(file(), kText);
  EXPECT_EQ(reloads_, 2);
  EXPECT_THAT(state_of_last(), HasSubstr("line/d/c BAD_NO_ANSWER"));
}

TEST_F(ConfigurationAgentTest, TheVersionThatReturnsIsNotTheOneBelowInTheList) {
  ASSERT_EQ(deploy(more_).first, 200u);
  agent_->reloaded("refused");
  ASSERT_EQ(deploy(std::string(kText) + "# second attempt\n").first, 200u);
  EXPECT_EQ(run("versions").second[1]["version"], version_of(more_));
  const std::string base = run("read").second["watch"]["base"];
  EXPECT_EQ(base, version_of(kText));
  EXPECT_EQ(run("rollback", {{"version", base}, {"why", "oops"}}).first, 200u);
  EXPECT_EQ(file(), kText);
}

TEST_F(ConfigurationAgentTest, AConfirmationEndsTheWatch) {
  const std::string version = deploy(more_).second["version"];
  agent_->reloaded("");
  EXPECT_EQ(run("confirm", {{"version", "0"}}).first, 409u);
  EXPECT_EQ(run("confirm", {{"version", version}}).first, 200u);
  qualities_->at("line/d/c") = Quality::kBadNoResponse;
  now_ += 1min;
  agent_->look();
  EXPECT_EQ(file(), more_);
  EXPECT_EQ(state_of_last(), "confirmed by anna");
}

TEST_F(ConfigurationAgentTest, ARefusedReloadRestoresTheFile) {
  ASSERT_EQ(deploy(more_).first, 200u);
  agent_->reloaded("no such interface");
  EXPECT_EQ(file(), kText);
  EXPECT_THAT(state_of_last(), HasSubstr("no such interface"));
}

TEST_F(ConfigurationAgentTest, TheReasonOfARefusedReloadShowsNoPassword) {
  ASSERT_EQ(deploy(more_).first, 200u);
  agent_->reloaded("b.yaml:3: 'postgresql://anna:s c#t@db/plant' does not respond");
  EXPECT_THAT(state_of_last(), HasSubstr("'postgresql://anna:__HIDDEN__@db/plant' does not"));
}

TEST_F(ConfigurationAgentTest, TheSecondEngineerSeesTheConflict) {
  const json mine{
      {"text", std::string(kText) + "# mine\n"}, {"base", version_of(kText)}, {"why", "x"}};
  ASSERT_EQ(deploy(more_).first, 200u);
  const auto [status, body] = run("deploy", mine);
  EXPECT_EQ(status, 409u);
  EXPECT_EQ(body["text"], more_);
  EXPECT_THAT(std::string(body["error"]), HasSubstr("anna"));
  EXPECT_EQ(file(), more_);
}

TEST_F(ConfigurationAgentTest, AWatchedVersionIsNotReplaced) {
  ASSERT_EQ(deploy(more_).first, 200u);
  EXPECT_EQ(deploy(std::string(kText) + "# third\n").first, 409u);
}

TEST_F(ConfigurationAgentTest, RefusesFaultsProtectedKeysAndEmptyReasons) {
  EXPECT_EQ(deploy("bridge: b\n").first, 400u);
  EXPECT_EQ(deploy(std::string(kText) + "metrics: { listen: 127.0.0.1:9464 }\n").first, 403u);
  EXPECT_EQ(run("deploy", {{"text", more_}, {"base", version_of(kText)}, {"why", ""}}).first, 400u);
  EXPECT_EQ(run("deploy", {{"base", version_of(kText)}, {"why", "x"}}).first, 400u);
  EXPECT_EQ(run("dance").first, 400u);
  EXPECT_EQ(agent_->run("[1]", "", {})->status, 400u);
  EXPECT_EQ(file(), kText);
  EXPECT_EQ(reloads_, 0);
}

TEST_F(ConfigurationAgentTest, AFileThatAnAdministratorChangesWithinTheWatchStays) {
  const std::string corrected = more_ + "# corrected by hand\n";
  for (const bool by_engineer : {false, true}) {
    ASSERT_EQ(deploy(more_).first, 200u);
    agent_->reloaded("");
    std::ofstream(file_) << corrected;
    qualities_->at("line/d/c") = Quality::kBadNoResponse;
    if (by_engineer) {
      EXPECT_EQ(run("rollback", {{"version", version_of(kText)}, {"why", "oops"}}).first, 409u);
    } else {
      now_ += 30s;
      agent_->look();
    }
    EXPECT_EQ(file(), corrected);
    EXPECT_FALSE(agent_->is_watching());
    EXPECT_EQ(state_of_last(), "not in force: the file was changed");
    std::ofstream(file_) << kText;
  }
  EXPECT_EQ(reloads_, 2) << "by the deployments only";
}

TEST_F(ConfigurationAgentTest, WaitsWhileTheBridgeReloads) {
  qualities_.reset();
  EXPECT_EQ(deploy(more_).first, 503u);
  EXPECT_EQ(file(), kText);
}

TEST_F(ConfigurationAgentTest, GoesBackToAVersion) {
  const std::string version = deploy(more_).second["version"];
  agent_->reloaded("");
  (void)run("confirm", {{"version", version}});
  const json back{{"version", version_of(kText)}, {"why", "too loud"}};
  EXPECT_EQ(run("rollback", back).first, 200u);
  EXPECT_EQ(file(), kText);
  EXPECT_TRUE(agent_->is_watching());
  EXPECT_EQ(run("rollback", {{"version", "../b"}, {"why", "x"}}).first, 404u);
}

TEST_F(ConfigurationAgentTest, ARollbackWithinTheWatchEndsIt) {
  ASSERT_EQ(deploy(more_).first, 200u);
  EXPECT_EQ(run("rollback", {{"version", version_of(kText)}, {"why", "oops"}}).first, 200u);
  EXPECT_EQ(file(), kText);
  EXPECT_FALSE(agent_->is_watching());
  EXPECT_EQ(state_of_last(), "rolled back by anna: oops");
}

TEST_F(ConfigurationAgentTest, ADraftCannotReadOtherFiles) {
  const test::ScratchFolder elsewhere;
  std::ofstream(elsewhere.path("o.csv")) << "name,at,type\nsecret,holding:1,uint16\n";
  std::string text = kText;
  const std::string list = "channels: [ { name: c, at: \"holding:1\", type: uint16 } ]";
  text.replace(text.find(list), list.size(), "channels: " + elsewhere.path("o.csv"));
  const auto [status, body] = run("check", {{"text", text}});
  EXPECT_EQ(status, 200u);
  EXPECT_THAT(body["faults"].dump(), HasSubstr("cannot be read"));
}

TEST_F(ConfigurationAgentTest, AConfigurationOfNearlyTwoMebibytesIsDeployedReadAndRolledBack) {
  std::string large = kText;
  while (large.size() < ConfigurationAgent::kMostText - 1000)
    large += "# " + std::string(997, '-') + '\n';
  ASSERT_EQ(deploy(large).first, 200u);
  agent_->reloaded("");
  const auto [status, body] = run("read");
  EXPECT_EQ(status, 200u) << body;
  EXPECT_EQ(body["text"], large);
  EXPECT_EQ(recover_configuration(file_), "");
  EXPECT_EQ(run("rollback", {{"version", version_of(kText)}, {"why", "a test"}}).first, 200u);
  EXPECT_EQ(file(), kText);
}

TEST_F(ConfigurationAgentTest, ARestartWithinTheWatchContinuesIt) {
  ASSERT_EQ(deploy(more_).first, 200u);
  EXPECT_EQ(recover_configuration(file_), "");
  start();
  EXPECT_TRUE(agent_->is_watching());
  qualities_->at("line/d/c") = Quality::kBadNoResponse;
  now_ += 30s;
  agent_->look();
  EXPECT_EQ(file(), kText);
}

TEST_F(ConfigurationAgentTest, TheSecondRestartWithinTheWatchRestoresTheFile) {
  ASSERT_EQ(deploy(more_).first, 200u);
  EXPECT_EQ(recover_configuration(file_), "");
  EXPECT_THAT(recover_configuration(file_), HasSubstr("rolled back"));
  EXPECT_EQ(file(), kText);
  EXPECT_EQ(recover_configuration(file_), "");
}

TEST_F(ConfigurationAgentTest, ADeploymentThatDidNotReachTheFileIsForgotten) {
  ASSERT_EQ(deploy(more_).first, 200u);
  std::ofstream(file_) << kText;
  EXPECT_EQ(recover_configuration(file_), "");
  start();
  EXPECT_FALSE(agent_->is_watching());
  EXPECT_EQ(file(), kText);
}

TEST_F(ConfigurationAgentTest, OnAFullDiskAGoodVersionIsKeptOnce) {
  ASSERT_EQ(deploy(more_).first, 200u);
  agent_->reloaded("");
  now_ += 30s;
  {
    const test::FullDisk full;
    for (int second = 0; second < 3; ++second) {
      EXPECT_NO_THROW(agent_->look());
      EXPECT_FALSE(agent_->is_watching());
      EXPECT_TRUE(agent_->needs_look());
    }
    EXPECT_EQ(audit_.size(), 2u) << "deploy, keep";
    EXPECT_TRUE(run("read").second["watch"].is_null());
    EXPECT_THAT(state_of_last(), HasSubstr("kept"));
    EXPECT_EQ(VersionFolder(file_).rows().back().state, "watching");
  }
  agent_->look();
  EXPECT_FALSE(agent_->needs_look());
  EXPECT_THAT(VersionFolder(file_).rows().back().state, HasSubstr("kept"));
}

TEST_F(ConfigurationAgentTest, OnAFullDiskTheFileOfBeforeReturns) {
  ::chmod(file_.c_str(), 0640);
  ASSERT_EQ(deploy(more_).first, 200u);
  agent_->reloaded("");
  qualities_->at("line/d/c") = Quality::kBadNoResponse;
  now_ += 30s;
  {
    const test::FullDisk full;
    agent_->look();
    EXPECT_EQ(file(), kText);
    EXPECT_EQ(reloads_, 2);
    EXPECT_FALSE(agent_->is_watching());
  }
  struct stat found {};
  ASSERT_EQ(::stat(file_.c_str(), &found), 0);
  EXPECT_EQ(found.st_mode & 0777, 0640u);
  agent_->look();
  std::ofstream(file_) << "changed in place";
  EXPECT_EQ(VersionFolder(file_).text_of(version_of(kText)), kText);
  EXPECT_THAT(VersionFolder(file_).rows().back().state, HasSubstr("rolled back"));
}

TEST_F(ConfigurationAgentTest, OnAFullDiskAConfirmationCountsAndADeploymentIsRefused) {
  const std::string version = deploy(more_).second["version"];
  agent_->reloaded("");
  const test::FullDisk full;
  EXPECT_EQ(run("confirm", {{"version", version}}).first, 200u);
  EXPECT_FALSE(agent_->is_watching());
  const auto [status, body] = deploy(std::string(kText) + "# third\n");
  EXPECT_EQ(status, 500u);
  EXPECT_THAT(std::string(body["hint"]), HasSubstr("free space"));
  EXPECT_EQ(file(), more_);
  EXPECT_FALSE(agent_->is_watching());
  EXPECT_EQ(state_of_last(), "confirmed by anna");
}

TEST_F(ConfigurationAgentTest, AResultThatWasNotRecordedIsShownAsSuch) {
  const std::string version = deploy(more_).second["version"];
  {
    const test::FullDisk full;
    ASSERT_EQ(run("confirm", {{"version", version}}).first, 200u);
  }
  EXPECT_EQ(recover_configuration(file_), "");
  start();
  EXPECT_FALSE(agent_->is_watching());
  EXPECT_THAT(state_of_last(), HasSubstr("not recorded"));
}

TEST(FileError, ADiskOrAQuotaIsFull) {
  for (const int code : {ENOSPC, EDQUOT}) EXPECT_TRUE(security::FileError("", code).is_full());
  EXPECT_FALSE(security::FileError("", EACCES).is_full());
}

constexpr const char* kMeter =
    "      - { name: meter, address: 7, channels: [ { name: power, at: \"holding:8\", type: int16, "
    "scale: 0.1, unit: kW }, { name: more, at: \"holding:9\", type: int16 } ] }\n";

TEST_F(ConfigurationAgentTest, FirstValuesAreThoseOfTheDraftAndNothingIsSaved) {
  const json request{{"text", std::string(kText) + kMeter}, {"bus", "line"}, {"device", "meter"}};
  EXPECT_EQ(run("probe", request).first, 0u);
  EXPECT_EQ(file(), kText);
  EXPECT_EQ(bus_, "line");
  const Command first = *probe_->next();
  EXPECT_EQ(first.ad_hoc->link.address, 7);
  EXPECT_GT(first.expires, now_);
  CommandResult result;
  result.values = {Value{23.5}};
  result.completed = now_ + 1s;
  probe_->on_result(result);
  result = rejection(*probe_->next(), Cause::kExpired, "expired", now_);
  probe_->on_result(result);
  EXPECT_FALSE(later_);
  probed_(probe_->devices(), clock());
  ASSERT_TRUE(later_);
  EXPECT_EQ(later_->status, 200u);
  const json body = json::parse(later_->body);
  EXPECT_EQ(body["left_out"], 0);
  const json good = body["values"][0], bad = body["values"][1];
  EXPECT_EQ(good["value"], 23.5);
  EXPECT_EQ(good["quality"], "GOOD");
  EXPECT_EQ(good["unit"], "kW");
  EXPECT_EQ(good["error"], "");
  EXPECT_EQ(good["at_ms"], 3'601'000);
  EXPECT_TRUE(bad["value"].is_null());
  EXPECT_EQ(bad["cause"], "EXPIRED");
  EXPECT_THAT(std::string(bad["error"]), HasSubstr("shorter timeout"));
  ASSERT_EQ(audit_.size(), 1u);
  EXPECT_EQ(audit_[0].what, "configuration: read first values");
  EXPECT_EQ(audit_[0].result, "of meter on line");
}

// An engineer may put the hidden password at another key, to see it in what the bridge responds.
TEST_F(ConfigurationAgentTest, AHiddenPasswordIsShownInNoResponse) {
  constexpr const char* kSecret = "7s3cret";
  std::ofstream(file_) << kText << "store: { url: \"postgresql://anna:" << kSecret << "@db/p\" }\n";
  for (const auto& [from, to] :
       std::map<std::string, std::string>{{"address: 1", "address: __HIDDEN__"},
                                          {"name: c", "name: __HIDDEN__"},
                                          {"type: uint16", "type: uint16, unit: __HIDDEN__"}}) {
    std::string text = kText;
    text.replace(text.find(from), from.size(), to);
    const auto [status, checked] = run("check", {{"text", text}});
    EXPECT_FALSE(checked["faults"].empty()) << to;
    EXPECT_THAT(checked.dump(), Not(HasSubstr(kSecret)));
    EXPECT_THAT(deploy(text).second.dump(), Not(HasSubstr(kSecret)));
    const auto probe = run("probe", {{"text", text}, {"bus", "line"}, {"device", "d"}});
    EXPECT_THAT(probe.second.dump(), Not(HasSubstr(kSecret)));
    if (probe.first != 0) continue;
    probe_->on_result(rejection(*probe_->next(), Cause::kExpired, "expired", now_));
    probed_(probe_->devices(), clock());
    EXPECT_THAT(later_->body, Not(HasSubstr(kSecret)));
  }
}

TEST_F(ConfigurationAgentTest, AHiddenPasswordIsValidOnlyWhereItIs) {
  const std::string text = "store: { url: \"postgresql://anna:p/w@db/p\" }\n";
  std::ofstream(file_) << kText << text;
  std::string shown = run("read").second["text"];
  EXPECT_TRUE(run("check", {{"text", shown}}).second["faults"].empty());
  EXPECT_EQ(deploy(shown + "log: { level: debug }\n").first, 200u);
  EXPECT_EQ(file(), kText + text + "log: { level: debug }\n");
  shown.replace(shown.find("name: d"), 7, "name: __HIDDEN__");
  shown.erase(shown.find("store"));
  EXPECT_THAT(run("check", {{"text", shown}}).second["faults"].dump(),
              HasSubstr("a hidden password is not valid at this place"));
  EXPECT_EQ(deploy(shown).first, 400u);
}

TEST_F(ConfigurationAgentTest, AProbeThatCannotRunIsRefused) {
  const std::string text = std::string(kText) + kMeter;
  const auto probe = [&](const std::string& draft, const char* bus, const char* device) {
    return run("probe", {{"text", draft}, {"bus", bus}, {"device", device}});
  };
  EXPECT_EQ(probe(text, "line", "other").first, 404u);
  EXPECT_EQ(probe(text, "other", "meter").first, 404u);
  const auto [status, body] = probe(text + "      - { name: x }\n", "line", "meter");
  EXPECT_EQ(status, 400u);
  EXPECT_FALSE(body["faults"].empty());
  EXPECT_EQ(run("probe", {{"bus", "line"}}).first, 400u);
  EXPECT_FALSE(probe_);
  std::string moved = text;
  moved.replace(moved.find("name: line"), 10, "name: hall");
  EXPECT_EQ(probe(moved, "hall", "meter").first, 409u) << "not running";
  EXPECT_EQ(probe(text, "line", "meter").first, 0u);
  probed_({}, clock());
  EXPECT_EQ(later_->status, 409u) << "another probe";
}

TEST_F(ConfigurationAgentTest, AScanRequestsTheFreeAddressesOfARunningBus) {
  const auto scan = [&](const char* bus, const char* protocol, const char* first,
                        const char* last) {
    return run("scan", {{"bus", bus}, {"protocol", protocol}, {"first", first}, {"last", last}});
  };
  EXPECT_EQ(scan("line", "modbus-tcp", "1", "3").first, 0u);
  EXPECT_EQ(probe_->next()->ad_hoc->link.address, 2) << "the bus has a device 1";
  probe_->on_result(rejection(*probe_->next(), Cause::kLeased, "leased", now_));
  probed_(probe_->devices(), clock());
  EXPECT_EQ(json::parse(later_->body)["error"], "leased");
  EXPECT_EQ(audit_[0].result, "addresses 1 to 3 of modbus-tcp on line");
  EXPECT_EQ(scan("line", "modbus-tcp", "1", "1").second["next"], nullptr);
  EXPECT_EQ(scan("hall", "modbus-tcp", "1", "3").first, 409u);
  for (const char* wrong : {"", "x", "-1", "70000", "1 "})
    EXPECT_EQ(scan("line", "modbus-tcp", wrong, "3").first, 400u) << wrong;
  EXPECT_EQ(scan("line", "modbus-rtu", "1", "3").first, 400u);
}

// A file of root in a folder of the bridge's user, or a disk with errors.
TEST(ConfigurationService, GoesOnWithVersionsThatItCannotRead) {
  const test::ScratchFolder scratch;
  const std::string file = scratch.path("b.yaml"), list = file + ".versions/versions.json";
  std::ofstream(file) << kText;
  std::filesystem::create_directories(list);  // a folder cannot be read as a file
  std::promise<std::string> replies[2];
  std::size_t replied = 0;
  ConfigurationService service(
      file,
      {.reload = [] {},
       .qualities = [] { return std::nullopt; },
       .audit = [](const AuditEntry&) {},
       .clock = [] { return UtcMapping{}; },
       .probe = [](const std::string&, const DeviceProbe&, const auto&) { return false; }},
      [&](const ConfigurationMessage& reply) { replies[replied++].set_value(reply.text); });
  service.refuse_for("");
  const auto read = [&](std::size_t number) {
    service.receive({"station", number, "b", R"({"operation": "read"})"}, "", "");
    auto reply = replies[number].get_future();
    return reply.wait_for(10s) == std::future_status::ready ? reply.get() : "no reply";
  };
  EXPECT_THAT(read(0), AllOf(HasSubstr("500"), HasSubstr("cannot read " + list)));
  std::filesystem::remove(list);
  EXPECT_THAT(read(1), HasSubstr("200"));
}

TEST(RefusalOfRequests, NeedsTheKeyAndASafeDomain) {
  BridgeSpec spec;
  EXPECT_THAT(refusal_of_requests(spec, true), HasSubstr("configure"));
  spec.configure.allow = true;
  EXPECT_EQ(refusal_of_requests(spec, true), "");
  EXPECT_THAT(refusal_of_requests(spec, false), HasSubstr("DDS Security"));
  spec.dds.security = "/etc/fieldcast/member";
  EXPECT_EQ(refusal_of_requests(spec, false), "");
}

}  // namespace
}  // namespace fieldcast::configure
