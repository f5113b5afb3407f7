#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <set>

#include "bridge/dds/topics/topics.hpp"
#include "bridge/security/subject.hpp"

namespace fieldcast::security {
namespace {

using enum MemberRole;
using testing::HasSubstr;
using testing::Not;

TEST(TopicRights, EveryTopicHasARowAndEveryRowATopic) {
  std::set<std::string_view> topics, rows;
  for (const TopicRow* topic : kTopics) topics.insert(topic->name);
  for (const TopicRight& right : topic_rights())
    EXPECT_TRUE(rows.insert(right.topic).second) << right.topic << " has two rows";
  EXPECT_EQ(rows, topics);
}

TEST(TopicRights, BridgesAndStationsNeverWriteTheSameTopicButTheirOwn) {
  for (const TopicRight& right : topic_rights()) {
    for (const MemberRole role : {kStation, kPlant, kStationReadonly, kEngineer}) {
      EXPECT_FALSE(right.writers.has(kBridge) && right.writers.has(role)) << right.topic;
      EXPECT_FALSE(right.writers.has(role) && right.readers.has(role)) << right.topic;
    }
  }
}

TEST(TopicRights, OnlyAPlantAndAnEngineerCommand) {
  for (const std::string_view topic : {"fieldcast/Command", "fieldcast/AlarmAction"}) {
    const TopicRight* right = right_of(topic);
    ASSERT_NE(right, nullptr);
    EXPECT_TRUE(right->by_bus);
    for (const RoleRow& row : roles())
      EXPECT_EQ(right->writers.has(row.role), row.role == kPlant || row.role == kEngineer);
  }
  const TopicRight* interests = right_of("fieldcast/Interest");
  EXPECT_TRUE(interests->writers.has(kStation));
  EXPECT_FALSE(interests->writers.has(kStationReadonly));
}

TEST(TopicRights, OnlyAnEngineerSeesAndChangesConfigurations) {
  for (const RoleRow& row : roles()) {
    const bool is_engineer = row.role == kEngineer;
    EXPECT_EQ(right_of("fieldcast/ConfigurationRequest")->writers.has(row.role), is_engineer);
    EXPECT_EQ(right_of("fieldcast/ConfigurationReply")->readers.has(row.role), is_engineer);
  }
}

TEST(TopicRights, WordsOfRolesAreReadBack) {
  for (const RoleRow& row : roles()) EXPECT_EQ(member_role_from(row.word), row.role);
  EXPECT_FALSE(member_role_from("operator"));
}

TEST(TopicRights, ANameThatWouldChangeADocumentIsRefused) {
  EXPECT_EQ(fault_of({kPlant, "mes-1", {"press-*"}}), "");
  EXPECT_NE(fault_of({kPlant, "", {}}), "");
  EXPECT_NE(fault_of({kPlant, "a/b", {}}), "");
  EXPECT_NE(fault_of({kPlant, "..", {}}), "");
  EXPECT_NE(fault_of({kPlant, "a<b", {}}), "");
  EXPECT_NE(fault_of({kPlant, std::string(kMaxMemberName + 1, 'a'), {}}), "");
  EXPECT_NE(fault_of({kPlant, "mes", {"press shop"}}), "");
  EXPECT_NE(fault_of({kPlant, "mes", {""}}), "");
  EXPECT_THAT(fault_of({kBridge, "line-7", {"press-*"}}), HasSubstr("only a plant"));
}

std::string permissions(const Member& member) {
  return permissions_text({member, "CN=x.1,OU=plant,O=Fieldcast", {0}, {86'400'000'000'000}});
}

TEST(Permissions, NameWhatTheRoleMayDoAndNothingElse) {
  const std::string readonly = permissions({kStationReadonly, "wall", {}});
  EXPECT_THAT(readonly, HasSubstr("<topic>fieldcast/Sample</topic>"));
  EXPECT_THAT(readonly, Not(HasSubstr("fieldcast/Command")));
  EXPECT_THAT(readonly, Not(HasSubstr("fieldcast/Interest")));
  EXPECT_THAT(readonly, HasSubstr("<default>DENY</default>"));
  EXPECT_THAT(readonly, HasSubstr("<not_before>1970-01-01T00:00:00</not_before>"));
  EXPECT_THAT(readonly, HasSubstr("<not_after>1970-01-02T00:00:00</not_after>"));
}

TEST(Permissions, HoldAPlantToItsBusesInARuleOfItsOwn) {
  const std::string free = permissions({kPlant, "mes", {}});
  const std::string held = permissions({kPlant, "mes", {"press-*", "mill"}});
  const auto rules = [](const std::string& text) {
    std::size_t count = 0;
    for (auto at = text.find("<allow_rule>"); at != std::string::npos;
         at = text.find("<allow_rule>", at + 1))
      ++count;
    return count;
  };
  EXPECT_EQ(rules(free), 1U);
  ASSERT_EQ(rules(held), 2U);
  const std::string own = held.substr(held.rfind("<allow_rule>"));
  EXPECT_THAT(own, HasSubstr("<topic>fieldcast/Command</topic>"));
  EXPECT_THAT(own, HasSubstr("<topic>fieldcast/AlarmAction</topic>"));
  EXPECT_THAT(own, HasSubstr("<partition>press-*</partition>"));
  EXPECT_THAT(own, HasSubstr("<partition>mill</partition>"));
  EXPECT_THAT(own, Not(HasSubstr("<partition>*</partition>")));
}

TEST(Governance, LetsNobodyInWithoutAnIdentity) {
  const std::string text = governance_text(Protection::kEncrypt);
  EXPECT_THAT(text, HasSubstr("<allow_unauthenticated_participants>false"));
  EXPECT_THAT(text, HasSubstr("<enable_join_access_control>true"));
  EXPECT_THAT(text, HasSubstr("<rtps_protection_kind>ENCRYPT<"));
  const std::string commands = text.substr(text.find("<topic_expression>fieldcast/Command<"));
  EXPECT_THAT(commands.substr(0, commands.find("</topic_rule>")),
              HasSubstr("<data_protection_kind>ENCRYPT<"));
  EXPECT_THAT(text, Not(HasSubstr("<enable_write_access_control>false")));
  EXPECT_THAT(text, Not(HasSubstr("<enable_read_access_control>false")));
  EXPECT_LT(text.find("<topic_expression>fieldcast/Command<"), text.find("<topic_expression>*<"))
      << "the first rule that matches holds";
  EXPECT_THAT(governance_text(Protection::kSign), HasSubstr("<rtps_protection_kind>SIGN<"));
}

TEST(Subjects, OfBridgesAreAboveThoseOfAllOthers) {
  for (const std::string name : {"a", "line-7", "press_shop", "x9"}) {
    const GuidStart bridge = guid_start(subject_for({kBridge, name, {}}));
    for (const MemberRole role : {kStation, kPlant, kStationReadonly})
      EXPECT_LT(guid_start(subject_for({role, name, {}})), bridge) << name;
  }
}

TEST(Subjects, AreReadBackFromTheirText) {
  const Subject subject = subject_for({kPlant, "mes-1", {}});
  EXPECT_EQ(subject_from("/O=Fieldcast/OU=plant/CN=" + subject.common_name()), subject);
  EXPECT_EQ(subject.text(), "plant mes-1");
  for (const char* const other :
       {"", "/O=Fieldcast/OU=plant/CN=mes-1", "/O=Fieldcast/OU=plant/CN=mes-1.01",
        "/O=Other/OU=plant/CN=mes-1.2", "/O=Fieldcast/OU=boss/CN=mes-1.2",
        "/O=Fieldcast/OU=plant/CN=mes-1.2/CN=b.1", "/O=Fieldcast/OU=plant/CN=m\n.2",
        "CN=mes-1.2,OU=plant,O=Fieldcast"})
    EXPECT_FALSE(subject_from(other)) << other;
}

}  // namespace
}  // namespace fieldcast::security
