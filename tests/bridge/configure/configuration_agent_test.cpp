#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <cerrno>
#include <filesystem>
#include <fstream>
#include <future>
#include <nlohmann/json.hpp>

#include "bridge/configure/configuration_service.hpp"
#include "tests/bridge/configure/configuration_agent_fixture.hpp"
#include "tests/support/full_disk.hpp"

namespace fieldcast::configure {
namespace {

using namespace std::chrono_literals;
using nlohmann::json;
using testing::AllOf;
using testing::HasSubstr;

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
