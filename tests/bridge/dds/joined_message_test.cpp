// Tests that RTPS messages are joined into one, byte by byte (RTPS 2.2, 8.3.4, 9.4).
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <vector>

#include "bridge/dds/filter/sent_message.hpp"

namespace fieldcast {
namespace {

using ::testing::ElementsAreArray;
using Octets = std::vector<std::uint8_t>;

template <class... Parts>
Octets row(const Parts&... parts) {
  Octets all;
  (all.insert(all.end(), parts.begin(), parts.end()), ...);
  return all;
}

const Octets kFrom{'R', 'T', 'P', 'S', 2, 3, 1, 15, 1, 15, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10};
const Octets kFromAnother{'R', 'T', 'P', 'S', 2, 3, 1, 15, 1, 15, 1, 2, 3, 4, 5, 6, 7, 8, 9, 11};
const Octets kStamp{0x09, 0x01, 8, 0, 1, 2, 3, 4, 5, 6, 7, 8};
const Octets kToOne{0x0e, 0x01, 12, 0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12};
const Octets kToAll{0x0e, 0x01, 12, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0};
const Octets kStatistics{0x80, 0x01, 4, 0, 9, 9, 9, 9};

Octets sample(std::uint8_t content) {
  return {0x15, 0x05, 4, 0, content, content, content, content};
}
const Octets kHeartbeat{0x07, 0x01, 4, 0, 1, 1, 1, 1};

Octets joined(const std::vector<Octets>& messages) {
  JoinedMessage all(1000);
  for (const Octets& message : messages) EXPECT_TRUE(all.append(message));
  const auto whole = all.whole();
  return {whole.begin(), whole.end()};
}

TEST(JoinedMessage, HasTheHeaderOnceAndEverySubmessageInItsOrder) {
  EXPECT_THAT(joined({row(kFrom, kStamp, sample(1)), row(kFrom, kStamp, sample(2), kHeartbeat)}),
              ElementsAreArray(row(kFrom, kStamp, sample(1), kStamp, sample(2), kHeartbeat)));
}

TEST(JoinedMessage, OfOneMessageIsThatMessage) {
  const Octets message = row(kFrom, kToOne, kStamp, sample(1), kStatistics);
  EXPECT_THAT(joined({message}), ElementsAreArray(message));
}

TEST(JoinedMessage, KeepsTheLastStatisticsBehindEverything) {
  const Octets latest{0x80, 0x01, 4, 0, 8, 8, 8, 8};
  EXPECT_THAT(
      joined({row(kFrom, kStamp, sample(1), kStatistics), row(kFrom, kStamp, sample(2), latest)}),
      ElementsAreArray(row(kFrom, kStamp, sample(1), kStamp, sample(2), latest)));
}

TEST(JoinedMessage, AReceiverOfOneMessageIsNoneOfTheNext) {
  EXPECT_THAT(joined({row(kFrom, kToOne, kStamp, sample(1)), row(kFrom, kStamp, sample(2)),
                      row(kFrom, kStamp, sample(3))}),
              ElementsAreArray(row(kFrom, kToOne, kStamp, sample(1), kToAll, kStamp, sample(2),
                                   kStamp, sample(3))));
  EXPECT_THAT(joined({row(kFrom, kStamp, sample(1)), row(kFrom, kToOne, kStamp, sample(2))}),
              ElementsAreArray(row(kFrom, kStamp, sample(1), kToOne, kStamp, sample(2))));
}

TEST(JoinedMessage, IsNoLongerThanAllowed) {
  JoinedMessage all(20 + 20 + 20);
  EXPECT_TRUE(all.append(row(kFrom, kStamp, sample(1))));
  EXPECT_TRUE(all.append(row(kFrom, kStamp, sample(2))));
  EXPECT_FALSE(all.append(row(kFrom, kStamp, sample(3))));
  EXPECT_EQ(all.whole().size(), 60u);
  all.clear();
  EXPECT_TRUE(all.empty());
  EXPECT_TRUE(all.append(row(kFrom, kStamp, sample(3)))) << "from the beginning";
}

TEST(JoinedMessage, RefusesWhatCannotStandBehindOthers) {
  const Octets good = row(kFrom, kStamp, sample(1));
  Octets short_one = good, big_endian = good, no_end = good, unknown = good;
  short_one.pop_back();
  big_endian[33] = 0x04;
  no_end[34] = 0;
  unknown[32] = 0x0c;  // INFO_SRC: another sender from here on
  const std::vector<Octets> bad = {{},
                                   kFrom,
                                   row(kFromAnother, kStamp, sample(1)),
                                   row(kFrom, sample(1)),  // it would get the time of the first
                                   row(kFrom, kStatistics, kStamp, sample(1)),
                                   short_one,
                                   big_endian,
                                   no_end,
                                   unknown};
  for (const Octets& message : bad) {
    JoinedMessage all(1000);
    ASSERT_TRUE(all.append(good));
    EXPECT_FALSE(all.append(message)) << ::testing::PrintToString(message);
    EXPECT_THAT(all.whole(), ElementsAreArray(good)) << "nothing changes";
  }
}

}  // namespace
}  // namespace fieldcast
