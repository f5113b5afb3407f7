#include <gtest/gtest.h>

#include <algorithm>

#include "bridge/dds/receivers/request_receiver.hpp"
#include "bridge/security/subject.hpp"

namespace fieldcast::security {
namespace {

const Subject kMes = subject_for({MemberRole::kPlant, "mes", {}});
const Subject kScada = subject_for({MemberRole::kPlant, "scada", {}});

RequesterRegistry::Participant participant_of(const Subject& subject, std::uint8_t last = 1) {
  RequesterRegistry::Participant participant;
  const GuidStart start = guid_start(subject);
  std::copy(start.begin(), start.end(), participant.value);
  participant.value[11] = last;
  return participant;
}

std::string token_of(const Subject& subject) {
  return "/O=Fieldcast/OU=" + std::string(to_text(subject.role)) + "/CN=" + subject.common_name();
}

TEST(RequesterRegistry, KnowsASubjectByItsGuid) {
  RequesterRegistry book;
  book.found(participant_of(kMes, 1), token_of(kMes));
  book.found(participant_of(kMes, 2), token_of(kMes));
  EXPECT_EQ(book.subject_of(participant_of(kMes, 1)), "plant mes");
  EXPECT_EQ(book.subject_of(participant_of(kMes, 2)), "plant mes");
  EXPECT_EQ(book.subject_of(participant_of(kMes, 3)), RequesterRegistry::kUnknown);
  book.lost(participant_of(kMes, 1));
  EXPECT_EQ(book.subject_of(participant_of(kMes, 1)), RequesterRegistry::kUnknown);
}

TEST(RequesterRegistry, TakesNoSubjectThatIsNotInTheGuid) {
  RequesterRegistry book;
  book.found(participant_of(kScada), token_of(kMes));
  EXPECT_EQ(book.subject_of(participant_of(kScada)), RequesterRegistry::kUnknown);
  book.found(participant_of(kMes), "/O=Fieldcast/OU=plant/CN=mes");
  EXPECT_EQ(book.subject_of(participant_of(kMes)), RequesterRegistry::kUnknown);
}

TEST(RequesterRegistry, GivesARequesterToTheFirstThatUsesIt) {
  RequesterRegistry book;
  EXPECT_TRUE(book.bind("panel:7", "plant mes"));
  EXPECT_TRUE(book.bind("panel:7", "plant mes"));
  EXPECT_FALSE(book.bind("panel:7", "plant scada"));
  EXPECT_TRUE(book.bind("panel:8", "plant scada"));
}

TEST(RequesterRegistry, ForgetsTheOldestBeyondItsLimit) {
  RequesterRegistry book;
  for (std::size_t i = 0; i <= RequesterRegistry::kMaxRequesters; ++i)
    EXPECT_TRUE(book.bind("panel:" + std::to_string(i), "plant mes"));
  EXPECT_TRUE(book.bind("panel:0", "plant scada"));
  EXPECT_FALSE(book.bind("panel:4096", "plant scada"));
}

}  // namespace
}  // namespace fieldcast::security
