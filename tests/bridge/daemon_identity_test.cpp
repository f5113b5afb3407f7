#include <gmock/gmock.h>
#include <signal.h>

#include <chrono>
#include <filesystem>
#include <fstream>
#include <functional>

#include "bridge/base/clock.hpp"
#include "bridge/base/exit_code.hpp"
#include "bridge/security/authority.hpp"
#include "bridge/security/file_access.hpp"
#include "tests/bridge/security/scratch_folder.hpp"
#include "tests/bridge/support/claimed_domain.hpp"
#include "tests/bridge/support/process.hpp"

namespace fieldcast {
namespace {

namespace fs = std::filesystem;
using std::chrono::seconds;
using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

class DaemonIdentity : public testing::Test {
 protected:
  DaemonIdentity() { authority_.add({security::MemberRole::kStation, "wall", {}}, now()); }
  static UtcTime now() { return read_clocks().utc; }

  std::string configure(const std::string& folder, std::uint32_t domain) const {
    const std::string path = scratch_.path("plant.yaml");
    std::ofstream(path) << "bridge: test\ndds: { domain: " << domain << ", security: " << folder
                        << " }\nbuses:\n  - name: one\n    port: { serial: "
                        << scratch_.path("none")
                        << " }\n    protocol: modbus-rtu\n    devices: [ { name: plc, address: 1, "
                           "channels: [ { name: a, at: \"holding:1\", type: int16 } ] } ]\n";
    return path;
  }

  test::ScratchFolder scratch_;
  security::Authority authority_ = security::Authority::create(
      scratch_.path("ca"), security::Protection::kEncrypt, read_clocks().utc);
  test::ClaimedDomain domain_;
};

TEST_F(DaemonIdentity, ThatIsBrokenIsRefusedAtAReloadAsAtTheStart) {
  const std::string folder = authority_.add({security::MemberRole::kBridge, "test", {}}, now());
  const std::string wall = scratch_.path("ca/members/wall");
  const std::string file = configure(folder, domain_.number());
  struct Fault {
    std::function<void()> make;
    std::string told;
  };
  const Fault faults[] = {
      {[&] { fs::permissions(folder + "/identity.key", fs::perms(0644)); }, "chmod 600"},
      {[&] { fs::rename(folder, folder + "-away"); }, "there is no folder " + folder},
      {[&] { std::ofstream(folder + "/identity.pem"); }, "/identity.pem is empty"},
      {[&] {
         security::replace(folder + "/identity.key", security::read_file(wall + "/identity.key"),
                           security::kOwnerOnly);
       },
       "the key is of another certificate"}};
  test::Process bridge(FIELDCAST_BRIDGE, {file});
  ASSERT_THAT(bridge.said("running: 1 bus"), HasSubstr("running: 1 bus"));
  const std::string good = scratch_.path("good");
  fs::copy(folder, good, fs::copy_options::recursive);
  std::size_t refused = 0;
  for (const Fault& fault : faults) {
    fault.make();
    bridge.signal(SIGHUP);
    EXPECT_THAT(bridge.said(fault.told), HasSubstr(fault.told));
    ++refused;
    test::Process anew(FIELDCAST_BRIDGE, {file});
    EXPECT_EQ(anew.exit_code(), static_cast<int>(ExitCode::kBadConfiguration)) << anew.output();
    EXPECT_THAT(anew.output(), HasSubstr(fault.told));
    fs::remove_all(folder);
    fs::copy(good, folder, fs::copy_options::recursive);
  }
  bridge.signal(SIGHUP);
  const std::string said = bridge.said("reloaded: 0 buses stopped");
  EXPECT_THAT(said, HasSubstr("reloaded: 0 buses stopped"));
  std::size_t told = 0;
  for (auto at = said.find("not reloaded: "); at != std::string::npos;
       at = said.find("not reloaded: ", at + 1))
    ++told;
  EXPECT_EQ(told, refused) << said;
  bridge.signal(SIGTERM);
  EXPECT_EQ(bridge.exit_code(), 0) << bridge.output();
}

TEST_F(DaemonIdentity, ThatIsOfNoUseHasAPlaceInTheCheck) {
  const std::string folder = authority_.add({security::MemberRole::kBridge, "test", {}}, now());
  const std::string wall = scratch_.path("ca/members/wall");
  const std::string good = scratch_.path("good");
  fs::copy(folder, good, fs::copy_options::recursive);
  const std::string file = configure(folder, domain_.number());
  const auto column = 28 + std::to_string(domain_.number()).size();
  const std::string place = file + ":2:" + std::to_string(column) + ": ";
  struct Fault {
    std::function<void()> make;
    std::string said;
  };
  const Fault faults[] = {
      {[&] { fs::remove_all(folder); },
       "there is no folder " + folder + "; fieldcast secure add makes one for each member"},
      {[&] { fs::remove(folder + "/governance.p7s"); },
       folder + " is no folder of a member: governance.p7s is missing"},
      {[&] { fs::permissions(folder, fs::perms(0777)); },
       folder + ": others may change it; chmod go-w " + folder},
      {[&] { fs::permissions(folder + "/identity.key", fs::perms(0644)); },
       folder + "/identity.key is open to others than its owner; chmod 600 " + folder +
           "/identity.key"},
      {[&] {
         security::replace(folder + "/identity.key", security::read_file(wall + "/identity.key"),
                           security::kOwnerOnly);
       },
       folder + ": the key is of another certificate"},
      {[&] {
         fs::remove_all(folder);
         fs::copy(wall, folder, fs::copy_options::recursive);
       },
       folder + ": a station is no bridge; fieldcast secure add bridge NAME"},
      {[&] {
         fs::remove_all(folder);
         fs::copy(authority_.add({security::MemberRole::kBridge, "other", {}}, now()), folder,
                  fs::copy_options::recursive);
       },
       folder +
           " is the identity of bridge other, and this bridge is named test: others would ignore "
           "its claims on buses; name it other, or fieldcast secure add bridge NAME"}};
  for (const Fault& fault : faults) {
    fault.make();
    test::Process check(FIELDCAST_BRIDGE, {file, "--check"});
    EXPECT_EQ(check.exit_code(), static_cast<int>(ExitCode::kBadConfiguration));
    EXPECT_THAT(check.output(), HasSubstr(place + "security: " + fault.said + '\n'));
    fs::remove_all(folder);
    fs::copy(good, folder, fs::copy_options::recursive);
  }
}

TEST_F(DaemonIdentity, WhoseCertificateEndsHasAPlaceInTheCheck) {
  const auto checked = [&](const std::string& name, Duration life) {
    const std::string folder =
        authority_.add({security::MemberRole::kBridge, name, {}}, now(), life);
    test::Process check(FIELDCAST_BRIDGE, {configure(folder, 5), "--check"});
    EXPECT_EQ(check.exit_code(), static_cast<int>(ExitCode::kBadConfiguration));  // of another name
    return check.output();
  };
  const std::string place = scratch_.path("plant.yaml") + ":2:29: ";
  EXPECT_THAT(checked("soon", std::chrono::hours{24}),
              HasSubstr(place + "warning: security: " + scratch_.path("ca/members/soon") +
                        ": the certificate ends on "));
  EXPECT_THAT(checked("late", -seconds{1}),
              HasSubstr(place + "security: " + scratch_.path("ca/members/late") +
                        ": the certificate ended on "));
}

TEST_F(DaemonIdentity, ThatEndsWhileItRunsIsAnErrorOfTheLog) {
  const std::string folder =
      authority_.add({security::MemberRole::kBridge, "test", {}}, now(), seconds{15});
  test::Process bridge(FIELDCAST_BRIDGE, {configure(folder, domain_.number())});
  EXPECT_THAT(bridge.said("running: 1 bus"),
              AllOf(HasSubstr("the certificate ends on"), Not(HasSubstr("ended on"))));
  EXPECT_THAT(bridge.said("the certificate with which this program joined ended on", seconds{60}),
              AllOf(HasSubstr("fieldcast secure renew test"),
                    HasSubstr("once it is renewed a reload (SIGHUP) takes it up")));
  bridge.signal(SIGTERM);
  EXPECT_EQ(bridge.exit_code(), 0) << bridge.output();
}

}  // namespace
}  // namespace fieldcast
