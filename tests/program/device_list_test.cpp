// The request for the list of devices: its frames, the bridge's side and the client's side.
#include "core/program/device_list.hpp"

#include <gmock/gmock.h>

#include "core/model/channel_kind.hpp"
#include "core/program/list_client.hpp"
#include "tests/program/engineer_bench.hpp"

namespace fieldcast::program {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using State = ListedDevice::State;
using Bench = EngineerBench;

const ListedDevice kBoiler{"P1", "boiler", "plc", State::kFree, ""};
const ListedDevice kPress{"17", "press", "plc", State::kInUse, "anna (10.0.0.4:4711)"};

std::string frames_of(const std::vector<ListedDevice>& devices, bool with_who = true) {
  return std::string(as_text(list_frames(devices, with_who)));
}

EngineerRules with_login() {
  EngineerRules rules;
  rules.login_needed = true;
  return rules;
}

TEST(DeviceList, HasAFrameForEachDeviceAndAnEnd) {
  EXPECT_EQ(frames_of({kBoiler, kPress}),
            "@@LDP1:0:626f696c6572:706c63:FEFF"
            "@@LD17:1:7072657373:706c63:616e6e61202831302e302e302e343a3437313129FEFF"
            "@@LE2FEFF");
  EXPECT_EQ(frames_of({kPress}, false), "@@LD17:1:7072657373:706c63:FEFF@@LE1FEFF");
  EXPECT_EQ(frames_of({}), "@@LE0FEFF");
}

TEST(DeviceList, TheLongestDeviceFitsInAFrame) {
  const std::string name(kMaxNameLength, '\xFE');
  const std::string user(1000, 'u');
  ListClient client("", "");
  const auto result =
      client.on_bytes(list_frames({{"ABCDEFGHIJKLMNOP", name, name, State::kInUse, user}}, true));
  ASSERT_TRUE(result && *result);
  EXPECT_EQ((*result)->devices.at(0).bus, name);
  EXPECT_THAT((*result)->devices.at(0).who, testing::EndsWith("uuu..."));
}

TEST(DeviceList, OtherCodesAreNotADeviceOrAnEnd) {
  EXPECT_EQ(listed_device_from("LD17:1:7072657373:706c63:"),
            (ListedDevice{"17", "press", "plc", State::kInUse, ""}));
  for (const char* bad : {"LD",
                          "LD17",
                          "LD17:0:61:62",
                          "LD17:0:61:62::",
                          "LD17:3:61:62:",
                          "LD17:00:61:62:",
                          "LD17::61:62:",
                          "LD:0:61:62:",
                          "LDED:0:61:62:",
                          "LD1 7:0:61:62:",
                          "LD17:0::62:",
                          "LD17:0:61::",
                          "LD17:0:6:62:",
                          "LD17:0:6A:62:",
                          "LD17:0:0a:62:",
                          "LD17:0:61:62:0d",
                          "LE1",
                          "ld17:0:61:62:",
                          "LD17:/:61:62:",
                          "LD17:0:61:6:",
                          "LD17:0:61:7f:",
                          "LD17:0:61:62:6",
                          "LD17:0:6`:62:",
                          "LD17:0:6g:62:",
                          "LD17:0:6/:62:"}) {
    EXPECT_FALSE(listed_device_from(bad)) << bad;
  }
  EXPECT_EQ(list_end_from("LE1024"), 1024u);
  for (const char* bad : {"LE", "LE-1", "LE1 ", "LE+1", "LE1234567890", "LEx", "LD1"})
    EXPECT_FALSE(list_end_from(bad)) << bad;
}

TEST(Engineer, ListsTheDevicesAndThenPairs) {
  Bench b;
  b.sends("@@LS:FEFF@@17FEFF");
  EXPECT_EQ(b.lists, 1);
  EXPECT_TRUE(b.taken.empty());  // until the list is sent
  b.tell(DevicesListed{{kBoiler, kPress}});
  EXPECT_EQ(b.received(), frames_of({kBoiler, kPress}, false));  // no names without a login
  EXPECT_THAT(b.taken, ElementsAre("17"));
  EXPECT_EQ(b.last_remark(), "2 devices listed");
  b.tell(DeviceGiven{});
  EXPECT_EQ(b.received(), "@@0000FEFF");
}

TEST(Engineer, OnlyClientsThatHaveLoggedInGetNames) {
  Bench b(with_login());
  b.sends("@@AU616e6e61:7365637265FEFF@@LS:FEFF");
  EXPECT_EQ(b.lists, 0);
  b.tell(LoginChecked{true, {}});
  EXPECT_EQ(b.lists, 1);
  b.tell(DevicesListed{{kPress}});
  EXPECT_EQ(b.received(), frames_of({kPress}));
}

TEST(Engineer, ListsNothingWithoutALogin) {
  Bench b(with_login());
  b.sends("@@LS:FEFF");
  EXPECT_EQ(b.received(), "@@0004FEFF");
  EXPECT_EQ(b.lists, 0);
  EXPECT_EQ(b.hung_up, 1);
  EXPECT_EQ(b.last_remark(), "the list of devices was requested without a login");
}

TEST(Engineer, AListThatArrivesAfterTheEndIsNotSent) {
  Bench b;
  b.sends("@@LS:FEFF");
  b.tell(ClientGone{"end of file"});
  b.tell(DevicesListed{{kBoiler}});
  EXPECT_EQ(b.received(), "");
  EXPECT_EQ(b.hung_up, 1);
}

TEST(Engineer, DisconnectsAClientThatStopsAfterTheList) {
  Bench b;
  b.sends("@@LS:FEFF");
  b.tell(DevicesListed{});
  b.sends("@@EDFEFF");
  EXPECT_EQ(b.hung_up, 1);
  EXPECT_THAT(b.last_remark(), HasSubstr("after the list"));
}

TEST(Engineer, AClientThatWaitsAfterTheListIsDisconnectedAsWithoutARequest) {
  Bench b;
  b.sends("@@LS:FEFF");
  b.pass(std::chrono::minutes{1});
  EXPECT_EQ(b.hung_up, 0);  // the list of the shell is pending
  b.tell(DevicesListed{});
  b.pass(std::chrono::seconds{11});
  EXPECT_EQ(b.hung_up, 1);
}

TEST(Engineer, OnlySoManyListsAreSentWithoutAPairing) {
  Bench b;
  for (unsigned i = 0; i < Engineer::kMaxLists; ++i) {
    b.sends("@@LS:FEFF");
    b.tell(DevicesListed{});
  }
  EXPECT_EQ(b.hung_up, 0);
  b.sends("@@LS:FEFF");
  EXPECT_EQ(b.hung_up, 1);
}

TEST(Engineer, ARequestForTheListIsProgramDataInTransmission) {
  Bench b;
  b.pair();
  b.sends("@@LS:FEFF\rFEFF");
  EXPECT_EQ(b.lists, 0);
  EXPECT_EQ(b.reached(), "LS:FEFF\r");
}

TEST(ListClient, LogsInAndRequestsTheList) {
  EXPECT_EQ(as_text(ListClient("", "").request()), "@@LS:FEFF");
  EXPECT_EQ(as_text(ListClient("anna", "secre").request()), "@@AU616e6e61:7365637265FEFF@@LS:FEFF");
}

TEST(ListClient, ReadsAListHoweverTheStreamIsCut) {
  const Bytes stream = list_frames({kBoiler, kPress}, true);
  for (std::size_t cut = 0; cut <= stream.size(); ++cut) {
    ListClient client("anna", "secret");
    auto result = client.on_bytes(ByteView(stream).first(cut));
    ASSERT_EQ(result.has_value(), cut == stream.size()) << cut;
    if (!result) result = client.on_bytes(ByteView(stream).subspan(cut));
    ASSERT_TRUE(result && *result) << cut;
    EXPECT_THAT((*result)->devices, ElementsAre(kBoiler, kPress));
    EXPECT_EQ((*result)->omitted, 0u);
    EXPECT_FALSE(client.on_bytes(stream));
  }
}

TEST(ListClient, ReportsTheDevicesThatALongListOmits) {
  ListClient client("", "");
  const auto result =
      client.on_bytes(list_frames(std::vector<ListedDevice>(kMaxListed + 3, kBoiler), false));
  ASSERT_TRUE(result && *result);
  EXPECT_EQ((*result)->devices.size(), kMaxListed);
  EXPECT_EQ((*result)->omitted, 3u);
}

// The message for what a bridge sends instead of a list.
PortEnd end_after(std::string_view stream, const std::string& user = "") {
  ListClient client(user, "guess");
  const auto result = client.on_bytes(as_bytes(stream));
  if (!result || *result) return {PortEnd::Kind::kStopped, {}, "no fault"};
  return result->error();
}

TEST(ListClient, ABridgeOfAnEarlierVersionDoesNotListItsDevices) {
  EXPECT_FALSE(is_device_number(kListCode));  // so an earlier bridge leases nothing
  for (const char* reply : {"@@0001FEFF", "@@HBFEFF@@0001FEFF", "@@0002FEFF"}) {
    const PortEnd end = end_after(reply);
    EXPECT_EQ(end.kind, PortEnd::Kind::kRefused);
    EXPECT_EQ(end.text, "the bridge does not list its devices: update it");
  }
}

TEST(ListClient, ARefusedLoginHasItsMessage) {
  EXPECT_THAT(end_after("@@0004FEFF").text, HasSubstr("a login of a user"));
  EXPECT_THAT(end_after("@@0004FEFF", "anna").text, HasSubstr("the login of anna is refused"));
}

TEST(ListClient, AnInvalidListIsAFault) {
  std::string long_list = frames_of(std::vector<ListedDevice>(kMaxListed, kBoiler), false);
  long_list.resize(long_list.rfind("@@LE"));
  long_list += "@@LD9:0:61:62:FEFF";
  const std::string endless = "@@LD" + std::string(kMaxHandshakeCode, '0');
  for (const std::string& stream : {std::string("HTTP/1.1 400 Bad Request\r\n"), endless, long_list,
                                    std::string("@@LD9:0:61:62:FEFF@@LE0FEFF"),
                                    std::string("@@LE1FE@@LE1FEFF"), std::string("@@P1FEFF")}) {
    EXPECT_EQ(end_after(stream).kind, PortEnd::Kind::kProtocol) << stream.substr(0, 40);
  }
}

TEST(DeviceList, StatesHaveTheTextsOfTheTable) {
  EXPECT_EQ(to_text(State::kFree), "free");
  EXPECT_EQ(to_text(State::kInUse), "in use");
  EXPECT_EQ(to_text(State::kNotOnline), "not online");
  EXPECT_EQ(to_text(static_cast<State>(3)), "?");
}

}  // namespace
}  // namespace fieldcast::program
