#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "bridge/dds/filter/sent_message.hpp"
#include "bridge/dds/receivers/taker.hpp"

namespace fieldcast {
namespace {

using ::testing::ElementsAreArray;

// Tests the notes of unregistered instances byte by byte (RTPS 2.2, 9.4.5.3, 9.6.3).

using Bytes = std::vector<std::uint8_t>;

template <class... Parts>
Bytes joined(const Parts&... parts) {
  Bytes all;
  (all.insert(all.end(), parts.begin(), parts.end()), ...);
  return all;
}

const Bytes kHeader{'R', 'T', 'P', 'S', 2, 3, 1, 15, 1, 15, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10};
const Bytes kTime{0x09, 0x01, 8, 0, 1, 2, 3, 4, 5, 6, 7, 8};
const Bytes kHash{16, 17, 18, 19, 20, 21, 22, 23, 24, 25, 26, 27, 28, 29, 30, 31};
const Bytes kSentinel{1, 0, 0, 0};
const Bytes kKey{0, 1, 0, 0, 2, 0, 0, 0, 'r', 0, 0, 0, 7, 0, 0, 0, 0, 0, 0, 0};

Bytes data(std::uint8_t flags, const Bytes& qos, const Bytes& payload) {
  const Bytes fixed{0, 0, 16, 0, 0, 0, 0, 7, 0, 0, 3, 2, 0, 0, 0, 0, 5, 0, 0, 0};
  const auto length = static_cast<std::uint8_t>(fixed.size() + qos.size() + payload.size());
  return joined(Bytes{0x15, flags, length, 0}, fixed, qos, payload);
}

Bytes mark() {
  rtps::InstanceHandle_t key;
  std::copy(kHash.begin(), kHash.end(), &key.value[0]);
  const auto identity = unregister_mark(key);
  Bytes bytes{0x0f, 0x80, 24, 0};
  const auto put = [&](const void* from, std::size_t size) {
    const auto* byte = static_cast<const std::uint8_t*>(from);
    bytes.insert(bytes.end(), byte, byte + size);
  };
  put(identity.writer_guid().guidPrefix.value, 12);
  put(identity.writer_guid().entityId.value, 4);
  put(&identity.sequence_number().high, 4);
  put(&identity.sequence_number().low, 4);
  return bytes;
}

Bytes turned(Bytes message) {
  turn_marks_into_notes(message);
  return message;
}

TEST(UnregisterNote, TakesThePlaceOfTheMark) {
  const Bytes plain = data(0x05, {}, kKey);
  const Bytes marked = data(0x07, joined(mark(), kSentinel), kKey);
  const Bytes note =
      data(0x0b, joined(Bytes{0x70, 0, 16, 0}, kHash, Bytes{0x71, 0, 4, 0, 0, 0, 0, 2}, kSentinel),
           kKey);
  const Bytes message = joined(kHeader, kTime, plain, marked, plain, marked);
  EXPECT_TRUE(holds_marks(message));
  EXPECT_EQ(turned(message), joined(kHeader, kTime, plain, note, plain, note));
  EXPECT_FALSE(holds_marks(turned(message)));
}

// As Fast DDS 3 writes the mark: also in the related sample of RTPS (0083), and with the key hash.
TEST(UnregisterNote, HasNoSecondKeyHash) {
  const Bytes hash = joined(Bytes{0x70, 0, 16, 0}, kHash);
  Bytes related = mark();
  related[0] = 0x83;
  related[1] = 0;
  const Bytes marked = data(0x07, joined(related, mark(), hash, kSentinel), kKey);
  const Bytes note = data(
      0x0b,
      joined(related, Bytes{0, 0, 16, 0}, kHash, Bytes{0x71, 0, 4, 0, 0, 0, 0, 2}, hash, kSentinel),
      kKey);
  EXPECT_EQ(turned(joined(kHeader, kTime, marked)), joined(kHeader, kTime, note));
}

TEST(UnregisterNote, LeavesEverythingElseAsItIs) {
  Bytes other = mark();
  other.back() ^= 1;  // another sequence number: not the mark
  for (const Bytes& message :
       {joined(kHeader, kTime, data(0x05, {}, kKey)),
        joined(kHeader, data(0x07, joined(other, kSentinel), kKey)),
        joined(kHeader, data(0x03, joined(mark(), kSentinel), {})),  // without a payload
        joined(Bytes(20, 'x'), data(0x07, joined(mark(), kSentinel), kKey)), Bytes{}}) {
    EXPECT_FALSE(holds_marks(message));
    EXPECT_EQ(turned(message), message);
  }
}

// The truncated message is at the end of its memory, so sanitizers detect every byte beyond.
TEST(UnregisterNote, OfMessagesThatAreCutNothingIsReadBeyondTheirEnd) {
  const Bytes whole = joined(kHeader, kTime, data(0x07, joined(mark(), kSentinel), kKey));
  for (std::size_t size = 0; size < whole.size(); ++size) {
    const Bytes cut(whole.begin(), whole.begin() + static_cast<std::ptrdiff_t>(size));
    EXPECT_EQ(turned(cut), cut) << size;
  }
}

// Tests that RTPS messages are joined into one, byte by byte (RTPS 2.2, 8.3.4, 9.4).

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

dds::InstanceHandle_t handle(std::uint8_t number) {
  dds::InstanceHandle_t made;
  made.value[15] = number;
  return made;
}
const auto kWriter = handle(1), kOther = handle(2);

TEST(LostInstances, AWriterThatReturnsHasWhatItHadWritten) {
  LostInstances<std::string> lost(10);
  lost.keep(kWriter, handle(3), "three");
  lost.keep(kWriter, handle(4), "four");
  lost.keep(kOther, handle(5), "five");
  const auto again = lost.take(kWriter);
  ASSERT_EQ(again.size(), 2U);
  EXPECT_EQ(again.at(handle(3)), "three");
  EXPECT_TRUE(lost.take(kWriter).empty()) << "once";
  EXPECT_EQ(lost.take(kOther).size(), 1U);
  EXPECT_EQ(lost.size(), 0U);
}

TEST(LostInstances, WhatALaterMessageReplacedDoesNotReturn) {
  LostInstances<std::string> lost(10);
  lost.keep(kWriter, handle(3), "three");
  lost.keep(kWriter, handle(4), "four");
  lost.forget(kWriter, handle(3));
  lost.forget(kOther, handle(4));
  EXPECT_EQ(lost.size(), 1U);
  EXPECT_EQ(lost.take(kWriter).count(handle(4)), 1U);
}

TEST(LostInstances, TheWriterThatWasLostFirstMakesRoom) {
  LostInstances<int> lost(100);
  for (std::uint8_t writer = 1; writer <= 200; ++writer)
    for (std::uint8_t instance = 0; instance < 10; ++instance)
      lost.keep(handle(writer), handle(instance), writer);
  EXPECT_EQ(lost.size(), 100U);
  EXPECT_TRUE(lost.take(handle(190)).empty());
  EXPECT_EQ(lost.take(handle(191)).size(), 10U);
  EXPECT_EQ(lost.take(handle(200)).size(), 10U);
}

TEST(LostInstances, OneWriterWithMoreThanThereIsSpaceForIsForgotten) {
  LostInstances<int> lost(5);
  for (std::uint8_t instance = 0; instance < 6; ++instance) lost.keep(kWriter, handle(instance), 0);
  EXPECT_EQ(lost.size(), 0U);
  lost.keep(kWriter, handle(9), 0);
  EXPECT_EQ(lost.take(kWriter).size(), 1U);
}

}  // namespace
}  // namespace fieldcast
