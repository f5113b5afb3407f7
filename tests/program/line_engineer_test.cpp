#include "core/program/line_engineer.hpp"

#include <gmock/gmock.h>

#include "tests/telnet/frames.hpp"

namespace fieldcast::program {
namespace {

using std::chrono::seconds;
using telnet::hex;
using telnet::Kind;
using telnet::option;
using testing::HasSubstr;

const LineFormat kLine{9600, 8, Parity::kNone, 1};

class LineEngineerTest : public testing::Test {
 protected:
  void make(bool telnet, bool login_needed = false) {
    EngineerRules rules;
    rules.login_needed = login_needed;
    rules.port = LinePort{"P1", telnet, {}};
    engineer_.emplace(rules, telnet::kStart);
    tell(TimerFired{});
  }
  void tell(const EngineerEvent& event) {
    EngineerActions actions;
    engineer_->on_event(event, now_, actions);
    for (const auto& action : actions) {
      if (const auto* what = std::get_if<ToClient>(&action)) append(to_client_, what->bytes);
      if (const auto* what = std::get_if<ToDevice>(&action)) append(to_device_, what->bytes);
      if (const auto* what = std::get_if<ChangeLine>(&action)) changes_.push_back(what->change);
      if (const auto* what = std::get_if<HoldDevice>(&action)) held_ = what->hold;
      if (const auto* what = std::get_if<CheckLogin>(&action))
        login_ = what->user + '/' + what->password;
      if (const auto* what = std::get_if<Remark>(&action)) remark_ = what->text;
      if (const auto* what = std::get_if<SetTimer>(&action)) timer_ = what->at;
      taken_ += std::holds_alternative<TakeDevice>(action);
      freed_ += std::holds_alternative<FreeDevice>(action);
      hung_up_ += std::holds_alternative<HangUp>(action);
    }
  }
  void send(const Bytes& bytes) { tell(FromClient{bytes}); }
  void type(std::string_view text) { tell(FromClient{as_bytes(text)}); }
  void give() { tell(DeviceGiven{kLine}); }
  std::string said() { return to_hex(std::exchange(to_client_, {})); }
  // Without Telnet requests.
  std::string shown() {
    telnet::Parser parser;
    const Bytes sent = std::exchange(to_client_, {});
    ByteView in = sent;
    std::string text;
    while (const auto item = parser.next(in)) {
      if (const auto* data = std::get_if<telnet::Data>(&*item)) text += as_text(data->bytes);
    }
    return text;
  }

  Instant now_ = telnet::kStart, timer_ = kNever;
  std::optional<LineEngineer> engineer_;
  Bytes to_client_, to_device_;

  std::vector<telnet::LineChange> changes_;
  std::string login_, remark_;
  bool held_ = false;
  int taken_ = 0, freed_ = 0, hung_up_ = 0;
};

TEST_F(LineEngineerTest, CarriesDataBothWays) {
  make(true);
  EXPECT_EQ(taken_, 1);
  give();
  said();
  send(hex("41 FF FF"));
  EXPECT_EQ(to_device_, hex("41 FF"));
  tell(FromDevice{hex("FF 42")});
  EXPECT_EQ(said(), "FF FF 42");
  EXPECT_EQ(engineer_->bytes_to_device(), 2u);
  EXPECT_EQ(engineer_->bytes_from_device(), 2u);
}

TEST_F(LineEngineerTest, ARawPortChangesNoByte) {
  make(false);
  EXPECT_EQ(said(), "");
  give();
  send(hex("FF FD 2C FF"));
  EXPECT_EQ(to_device_, hex("FF FD 2C FF"));
  tell(FromDevice{hex("FF 42")});
  EXPECT_EQ(said(), "FF 42");
}

TEST_F(LineEngineerTest, BytesBeforeTheDeviceWait) {
  make(true);
  said();
  send(telnet::together({option("01 00 00 4B 00"), "41"}));
  EXPECT_EQ(said(), "");
  give();
  EXPECT_EQ(to_device_, hex("41"));
  EXPECT_EQ(changes_, (std::vector{telnet::LineChange{Kind::kBaud, 19200}}));
  tell(LineChanged{changes_[0], true});
  EXPECT_EQ(said(), option("65 00 00 4B 00"));
  tell(LineChanged{{Kind::kBaud, 4800}, false});
  EXPECT_EQ(said(), option("65 00 00 4B 00"));
}

TEST_F(LineEngineerTest, AFloodBeforeTheDeviceEndsTheConnection) {
  make(true);
  send(Bytes(LineEngineer::kMaxEarly));
  EXPECT_EQ(hung_up_, 0);
  send(Bytes(1));
  EXPECT_EQ(hung_up_, 1);
  EXPECT_EQ(freed_, 1);
}

TEST_F(LineEngineerTest, LogsInAtThePromptWithoutEchoOfThePassword) {
  make(true, true);
  EXPECT_EQ(taken_, 0);
  EXPECT_EQ(shown(), "user: ");
  type("annb");
  type("\x7F");
  type("a\r\n");
  EXPECT_EQ(shown(), "annba\r\npassword: ");
  type("secret\r");
  EXPECT_EQ(shown(), "\r\n");
  EXPECT_EQ(login_, "anna/secret");
  type("\n@00");  // of the return; then bytes for the device
  tell(LoginChecked{true, {}});
  EXPECT_EQ(taken_, 1);
  give();
  EXPECT_EQ(as_text(to_device_), "@00");
}

TEST_F(LineEngineerTest, DataBehindThePasswordReachesTheDeviceOnce) {
  make(true, true);
  type("anna\nsecret\r");
  send(telnet::together({"0A 41 FF FF FF FF"}));
  tell(LoginChecked{true, {}});
  give();
  EXPECT_EQ(to_device_, hex("41 FF FF"));
  make(true, true);
  to_device_.clear();
  send(telnet::together({"61 0D 62 0D 0A 41 FF FF", "FF FF 42"}));
  tell(LoginChecked{true, {}});
  give();
  EXPECT_EQ(to_device_, hex("41 FF FF 42"));
}

TEST_F(LineEngineerTest, ARefusedLoginEndsTheConnection) {
  make(true, true);
  type("anna\rwrong\r");
  said();
  tell(LoginChecked{false, "user anna: wrong password"});
  EXPECT_EQ(shown(), "login refused\r\n");
  EXPECT_EQ(remark_, "user anna: wrong password");
  EXPECT_EQ(hung_up_, 1);
  EXPECT_EQ(taken_ + freed_, 0);
}

TEST_F(LineEngineerTest, SettingsBeforeTheLoginReachTheLineLater) {
  make(true, true);
  said();
  send(hex(option("01 00 01 C2 00")));
  EXPECT_EQ(said(), option("65 00 01 C2 00"));
  type("anna\rsecret\r");
  tell(LoginChecked{true, {}});
  give();
  EXPECT_EQ(changes_, (std::vector{telnet::LineChange{Kind::kBaud, 115200}}));
}

TEST_F(LineEngineerTest, NoLoginInTimeEndsTheConnection) {
  make(true, true);
  EXPECT_EQ(timer_, telnet::kStart + LineEngineer::kPromptWait);
  now_ = timer_;
  tell(TimerFired{});
  EXPECT_EQ(hung_up_, 1);
}

TEST_F(LineEngineerTest, TheClientSuspendsTheDevice) {
  make(true);
  give();
  send(hex(option("08")));
  EXPECT_TRUE(held_);
  send(hex(option("09")));
  EXPECT_FALSE(held_);
}

TEST_F(LineEngineerTest, ReportsModemLinesToAClientOfRfc2217) {
  make(true);
  give();
  said();
  tell(LineState{.modem = 0xB0});
  EXPECT_EQ(said(), "");
  send(hex("FF FB 2C"));
  tell(LineState{.modem = 0xB0});
  EXPECT_EQ(said(), option("6B BB"));
}

TEST_F(LineEngineerTest, ReportsErrorsOfTheLineThatTheMaskNames) {
  make(true);
  give();
  send(hex("FF FB 2C"));
  said();
  tell(LineState{.errors = 0x0C});
  EXPECT_EQ(said(), "");  // the mask is empty at first
  send(hex(option("0A 14")));
  EXPECT_EQ(said(), option("6E 14"));
  tell(LineState{.errors = 0x0C});
  EXPECT_EQ(said(), option("6A 04"));
  tell(LineState{});
  EXPECT_EQ(said(), "");
}

TEST_F(LineEngineerTest, ARefusedDeviceIsNotFreed) {
  make(true);
  said();
  tell(DeviceRefused{Reply::kInUse, "in use by bob"});
  EXPECT_THAT(shown(), HasSubstr("refused: "));
  EXPECT_EQ(remark_, "in use by bob");
  EXPECT_EQ(freed_, 0);
  EXPECT_EQ(hung_up_, 1);
}

TEST_F(LineEngineerTest, ARawPortHasNoPromptForAPassword) {
  make(false, true);
  EXPECT_EQ(hung_up_, 1);
  EXPECT_EQ(taken_, 0);
  EXPECT_EQ(remark_, "a certificate is needed");
}

TEST_F(LineEngineerTest, AnIdleSessionAndALostDeviceFreeTheDevice) {
  make(false);
  give();
  EXPECT_EQ(timer_, telnet::kStart + EngineerRules{}.idle);
  now_ = telnet::kStart + seconds{60};
  send(hex("41"));
  now_ = telnet::kStart + EngineerRules{}.idle;
  tell(TimerFired{});
  EXPECT_EQ(hung_up_, 0);
  now_ = timer_;
  tell(TimerFired{});
  EXPECT_EQ(freed_, 1);
  EXPECT_THAT(remark_, HasSubstr("no program byte for 10min"));
  make(false);
  give();
  tell(DeviceLost{"unplugged"});
  EXPECT_EQ(freed_, 2);
  tell(ClientGone{"closed"});
  EXPECT_EQ(hung_up_, 2);
}

TEST_F(LineEngineerTest, ASideThatTakesNoBytesEndsTheSession) {
  make(true);
  give();
  tell(ClientTakes{false});
  EXPECT_EQ(timer_, telnet::kStart + LineEngineer::kStuckWait);
  now_ = telnet::kStart + seconds{30};
  tell(ClientDrains{});
  now_ = timer_;
  EXPECT_EQ(now_, telnet::kStart + seconds{30} + LineEngineer::kStuckWait);
  tell(TimerFired{});
  EXPECT_EQ(freed_, 1);
  EXPECT_THAT(remark_, HasSubstr("the client takes no bytes for 60s"));
}

TEST_F(LineEngineerTest, ADeviceThatTakesNoBytesEndsTheSession) {
  make(false);
  give();
  tell(DeviceTakes{false});
  now_ = telnet::kStart + seconds{20};
  tell(DeviceDrains{});
  EXPECT_EQ(timer_, now_ + LineEngineer::kStuckWait);
  tell(DeviceTakes{true});
  EXPECT_EQ(timer_, now_ + EngineerRules{}.idle);
  tell(DeviceDrains{});  // it takes bytes: nothing to wait for
  EXPECT_EQ(timer_, now_ + EngineerRules{}.idle);
  tell(DeviceTakes{false});
  now_ = timer_;
  tell(TimerFired{});
  EXPECT_EQ(freed_, 1);
  EXPECT_THAT(remark_, HasSubstr("the device takes no bytes for 60s"));
}

// Otherwise a client that has not logged in could fill the memory.
TEST_F(LineEngineerTest, AClientThatReadsNoResponsesIsDisconnected) {
  make(true, true);
  said();
  const Bytes signature = hex(option("00"));
  const auto request = [&] {
    for (std::size_t sent = 0; sent <= LineEngineer::kMaxResponses; sent += signature.size())
      send(signature);
  };
  request();
  EXPECT_EQ(hung_up_, 0) << "it reads them";
  tell(ClientTakes{false});
  tell(ClientTakes{true});
  request();
  EXPECT_EQ(hung_up_, 0) << "it reads them again";
  said();
  tell(ClientTakes{false});
  request();
  EXPECT_EQ(hung_up_, 1);
  EXPECT_THAT(remark_, HasSubstr("reads no responses"));
  EXPECT_LT(to_client_.size(), LineEngineer::kMaxResponses + 100);
}

TEST_F(LineEngineerTest, AClientThatReadsNoResponsesToItsChangesFreesTheDevice) {
  make(true);
  give();
  tell(ClientTakes{false});
  for (std::size_t i = 0; i < LineEngineer::kMaxResponses / 4 && hung_up_ == 0; ++i)
    tell(LineChanged{{Kind::kPurge, 1}, true});
  EXPECT_EQ(hung_up_, 1);
  EXPECT_EQ(freed_, 1);
}

TEST_F(LineEngineerTest, TheRemarkSaysWhenTheClientDisconnected) {
  make(true, true);
  tell(ClientGone{"reset"});
  EXPECT_THAT(remark_, HasSubstr("the client disconnected before it was paired: reset"));
  EXPECT_EQ(freed_, 0);
  make(true);
  give();
  tell(ClientGone{"reset"});
  EXPECT_THAT(remark_, HasSubstr("the client disconnected: reset"));
  EXPECT_EQ(freed_, 1);
}

TEST_F(LineEngineerTest, AnEndFromOutsideIsShownToATelnetClient) {
  make(true);
  give();
  shown();
  tell(Ended{"the bridge stops"});
  EXPECT_EQ(shown(), "the bridge stops\r\n");
  EXPECT_EQ(freed_, 1);
  make(false);
  give();
  tell(Ended{"the bridge stops"});
  EXPECT_EQ(said(), "") << "software reads a raw port";
}

TEST_F(LineEngineerTest, EventsOfADeviceThatIsNotPairedChangeNothing) {
  make(true, true);
  shown();
  tell(DeviceGiven{kLine});
  tell(FromDevice{hex("41")});
  tell(LineChanged{{Kind::kBaud, 9600}, true});
  tell(LineState{.modem = 0xB0});
  tell(LoginChecked{true, {}});
  tell(DeviceRefused{Reply::kInUse, "late"});
  tell(DeviceLost{"late"});
  EXPECT_EQ(said(), "");
  EXPECT_EQ(taken_ + freed_ + hung_up_, 0);
}

TEST_F(LineEngineerTest, TheEraseKeysOfTheUserNameAreBackspaceAndDelete) {
  make(true, true);
  type(
      "\b\x7F"
      "axx\b\x7F"
      "nna\r");
  type(std::string(kMaxLoginText + 5, 'p') + "\x01\r");
  EXPECT_EQ(login_, "anna/" + std::string(kMaxLoginText, 'p'));
}

TEST_F(LineEngineerTest, ACertificateReplacesThePrompt) {
  for (const bool telnet : {true, false}) {
    EngineerRules rules;
    rules.login_needed = rules.by_certificate = true;
    rules.port = LinePort{"P1", telnet, {}};
    taken_ = 0;
    engineer_.emplace(rules, telnet::kStart);
    tell(TimerFired{});
    EXPECT_EQ(shown(), "");
    EXPECT_EQ(taken_, 0) << "before its user is checked";
    tell(LoginChecked{true, {}});
    EXPECT_EQ(taken_, 1);
  }
}

TEST_F(LineEngineerTest, ThePromptForThePasswordHasTheSameLimit) {
  make(true, true);
  type("anna\r");
  shown();
  now_ = timer_ - seconds{1};
  tell(TimerFired{});
  EXPECT_EQ(hung_up_, 0);
  now_ += seconds{1};
  tell(TimerFired{});
  EXPECT_EQ(shown(), "too late\r\n");
  EXPECT_EQ(hung_up_, 1);
}

TEST_F(LineEngineerTest, TheSecondByteOfAReturnIsNotData) {
  const std::pair<Bytes, std::string_view> kTyped[] = {
      {hex("0A 41"), "A"}, {hex("00 41"), "A"}, {hex("41"), "A"}, {{}, ""}};
  for (const auto& [bytes, data] : kTyped) {
    make(true, true);
    to_device_.clear();
    type("anna\rsecret\r");
    send(bytes);
    tell(LoginChecked{true, {}});
    give();
    EXPECT_EQ(as_text(to_device_), data) << to_hex(bytes);
  }
  make(true, true);
  to_device_.clear();
  type("anna\rsecret\rA");
  tell(LoginChecked{true, {}});
  give();
  EXPECT_EQ(as_text(to_device_), "A");
}

TEST_F(LineEngineerTest, ASettingThatTheLineHasAlreadyChangesNothing) {
  make(true, true);
  send(telnet::together({option("01 00 00 25 80"), option("02 07")}));
  type("anna\rsecret\r");
  tell(LoginChecked{true, {}});
  give();
  EXPECT_EQ(changes_, (std::vector{telnet::LineChange{Kind::kDataBits, 7}}));
}

TEST_F(LineEngineerTest, ARefusalWithoutAReasonHasTheTextOfItsReply) {
  make(true);
  tell(DeviceRefused{Reply::kInUse, ""});
  EXPECT_EQ(remark_, to_text(Reply::kInUse));
}

TEST_F(LineEngineerTest, ADeviceThatIsLostBeforeItIsGivenEndsTheConnection) {
  make(true);
  tell(DeviceLost{"unplugged"});
  EXPECT_EQ(freed_, 1);
  EXPECT_EQ(hung_up_, 1);
  EXPECT_THAT(remark_, HasSubstr("the device is lost: unplugged"));
}

TEST_F(LineEngineerTest, ModemLinesAreForClientsOfRfc2217Only) {
  for (const bool telnet : {true, false}) {
    make(telnet);
    give();
    said();
    tell(LineState{.modem = 0xB0});
    tell(FromDevice{});
    EXPECT_EQ(said(), "") << telnet;
  }
}

TEST_F(LineEngineerTest, AListOfDevicesAndASlowClientWithoutAQueueChangeNothing) {
  make(true);
  give();
  said();
  const Instant idle = timer_;
  now_ += seconds{5};
  tell(ClientDrains{});
  tell(DevicesListed{});
  EXPECT_EQ(timer_, idle);
  EXPECT_EQ(said(), "");
}

TEST_F(LineEngineerTest, RequestsBehindTheOneThatEndsTheConnectionAreNotExecuted) {
  make(true);
  give();
  tell(ClientTakes{false});
  const Bytes signature = hex(option("00"));
  Bytes all;
  for (std::size_t sent = 0; sent <= LineEngineer::kMaxResponses; sent += signature.size())
    append(all, signature);
  append(all, hex(option("02 07")));
  send(all);
  EXPECT_EQ(hung_up_, 1);
  EXPECT_TRUE(changes_.empty());
}

}  // namespace
}  // namespace fieldcast::program
