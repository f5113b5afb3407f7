// Drafts that are checked and tried without a deployment, and their passwords.
#include <gmock/gmock.h>

#include <map>

#include "tests/bridge/configure/configuration_agent_fixture.hpp"

namespace fieldcast::configure {
namespace {

using namespace std::chrono_literals;
using testing::HasSubstr;
using testing::Not;

class ConfigurationDraft : public ConfigurationAgentTest {};

constexpr const char* kMeter =
    "      - { name: meter, address: 7, channels: [ { name: power, at: \"holding:8\", type: int16, "
    "scale: 0.1, unit: kW }, { name: more, at: \"holding:9\", type: int16 } ] }\n";

TEST_F(ConfigurationDraft, FirstValuesAreThoseOfTheDraftAndNothingIsSaved) {
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
TEST_F(ConfigurationDraft, AHiddenPasswordIsShownInNoResponse) {
  constexpr const char* kSecret = "7s3cret";
  constexpr const char* kHiddenBus =
      "name: __HIDDEN__\n    gateway: { listen: \"127.0.0.1:1502\" }";
  std::ofstream(file_) << kText << "store: { url: \"postgresql://anna:" << kSecret << "@db/p\" }\n";
  for (const auto& [from, to] :
       std::map<std::string, std::string>{{"address: 1", "address: __HIDDEN__"},
                                          {"name: c", "name: __HIDDEN__"},
                                          {"name: line", kHiddenBus},
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

TEST_F(ConfigurationDraft, AHiddenPasswordIsValidOnlyWhereItIs) {
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

// The description of a channel is published to every viewer.
TEST_F(ConfigurationDraft, AHiddenPasswordIsNotPublishedAsADescription) {
  const std::string store = "store: { url: \"postgresql://anna:p@db/p\" }\n";
  const std::string comment = "# password: x\n";
  const std::string channel = "name: c, ";
  const auto described = [&](std::string text, const std::string& description) {
    return text.insert(text.find(channel) + channel.size(), "description: " + description + ", ");
  };
  std::ofstream(file_) << store << kText << comment;
  const std::string before = file();
  std::string alias = described(run("read").second["text"], "*u");
  alias.insert(alias.find('"'), "&u ");
  const std::string moved = described("# password: __HIDDEN__\n" + std::string(kText) + store,
                                      "\"password: __HIDDEN__\"");
  std::string from_comment = described(run("read").second["text"], "__HIDDEN__");
  from_comment.erase(from_comment.find("# password"));
  for (const std::string& text : {alias, moved, from_comment}) {
    EXPECT_THAT(run("check", {{"text", text}}).second["faults"].dump(),
                HasSubstr("a hidden password is not valid at this place"))
        << text;
    EXPECT_EQ(deploy(text).first, 400u) << text;
    EXPECT_EQ(file(), before);
  }
  const std::string plain = described(run("read").second["text"], "a pump");
  EXPECT_TRUE(run("check", {{"text", plain}}).second["faults"].empty());
  EXPECT_EQ(deploy(plain).first, 200u);
  EXPECT_EQ(file(), described(before, "a pump"));
}

// The loader reads the escaped URL as before, and the file shows it to engineers.
TEST_F(ConfigurationDraft, AHiddenPasswordStaysHiddenInTheFile) {
  std::ofstream(file_) << kText << "store: { url: \"postgresql://anna:p@db/p\" }\n"
                       << "# password: x\n";
  const std::string before = file(), shown = run("read").second["text"];
  for (const auto& [from, to] : std::map<std::string, std::string>{
           {"postgresql://", "postgresql:\\x2f/"}, {"# password:", "# it is"}}) {
    std::string text = shown;
    text.replace(text.find(from), from.size(), to);
    EXPECT_FALSE(run("check", {{"text", text}}).second["faults"].empty()) << text;
    EXPECT_EQ(deploy(text).first, 400u) << text;
    EXPECT_EQ(file(), before);
  }
}

TEST_F(ConfigurationDraft, AProbeThatCannotRunIsRefused) {
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

TEST_F(ConfigurationDraft, AScanRequestsTheFreeAddressesOfARunningBus) {
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

}  // namespace
}  // namespace fieldcast::configure
