// Tests the notes of unregistered instances byte by byte (RTPS 2.2, 9.4.5.3, 9.6.3).
#include <gtest/gtest.h>

#include <vector>

#include "bridge/dds/filter/sent_message.hpp"

namespace fieldcast {
namespace {

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

}  // namespace
}  // namespace fieldcast
