// Compares the declaration of Modbus RTU with the built-in protocol. Seeded.
#include <gtest/gtest.h>

#include <cstdlib>
#include <random>

#include "core/codec/checksum.hpp"
#include "tests/support/declared_device.hpp"
#include "tests/support/matrix.hpp"

namespace fieldcast::test {
namespace {

constexpr std::uint16_t kUnit = 17;

const Device& declared_modbus() {
  static const Device device = declared_device("modbus-rtu-declared", kUnit);
  return device;
}
const Device& built_in() {
  static const Device device("modbus-rtu", kUnit);
  return device;
}

class Requests {
 public:
  explicit Requests(unsigned seed) : random_(seed) {}
  std::uint32_t below(std::uint32_t limit) { return static_cast<std::uint32_t>(random_() % limit); }
  Request next() {
    const bool bits = below(2) == 0;
    Range range{static_cast<AreaIndex>((bits ? 0 : 2) + below(2)), below(65536),
                1 + below(below(4) == 0 ? 2100 : 130)};
    if (below(2) == 0) return ReadRequest{{range}};
    if (below(3) == 0) range.count = 1;
    WriteRequest write{.range = range,
                       .items = Bytes(image_bytes(bits ? 1 : 16, range.count)),
                       .distinct_response = below(4) == 0};
    for (auto& byte : write.items)
      byte = static_cast<std::uint8_t>(bits ? random_() % 2 : random_());
    return write;
  }

 private:
  std::mt19937 random_;
};

void append_crc(Bytes& frame) {
  const auto crc = crc16_modbus(frame);
  frame.push_back(static_cast<std::uint8_t>(crc));
  frame.push_back(static_cast<std::uint8_t>(crc >> 8));
}

// Returns a correct response, built from the bytes of the request alone.
Bytes answer_to(const Bytes& request, std::mt19937& random) {
  Bytes answer(request.begin(), request.begin() + 2);
  if (request[1] <= 4) {
    const unsigned count = read_u16(request, 4);
    const unsigned bytes = request[1] <= 2 ? (count + 7) / 8 : 2 * count;
    answer.push_back(static_cast<std::uint8_t>(bytes));
    for (unsigned i = 0; i < bytes; ++i) answer.push_back(static_cast<std::uint8_t>(random()));
    if (request[1] <= 2 && count % 8 != 0)
      answer.back() &= static_cast<std::uint8_t>((1u << count % 8) - 1);
  } else {
    answer.insert(answer.end(), request.begin() + 2, request.begin() + 6);
  }
  append_crc(answer);
  return answer;
}

void expect_same(const Outcome& ours, const Outcome& theirs, const std::string& what, bool cause) {
  EXPECT_EQ(ours.done(), theirs.done())
      << what << ": " << to_text(ours) << ", built in: " << to_text(theirs);
  if (cause || theirs.cause == Cause::kDeviceError || ours.cause == Cause::kDeviceError) {
    EXPECT_EQ(ours.cause, theirs.cause)
        << what << ": " << to_text(ours) << ", built in: " << to_text(theirs);
    EXPECT_EQ(ours.code, theirs.code) << what;
  }
  ASSERT_EQ(ours.reply.size(), theirs.reply.size()) << what;
  for (std::size_t i = 0; i < ours.reply.size(); ++i)
    EXPECT_EQ(ours.reply[i].items, theirs.reply[i].items) << what;
}

void expect_same(const Request& request, const Bytes& answer, const std::string& what,
                 bool cause = true) {
  const auto ours = declared_modbus().begin(request), theirs = built_in().begin(request);
  expect_same(drive(*ours, answer), drive(*theirs, answer),
              what + ", request " + to_hex(declared_modbus().request_bytes(request)).substr(0, 60) +
                  ", answer " + to_hex(answer).substr(0, 60),
              cause);
}

TEST(DeclaredModbus, SendsByteForByteWhatTheBuiltInOneSends) {
  Requests requests(1);
  unsigned sent = 0;
  for (int i = 0; i < 20000; ++i) {
    const Request request = requests.next();
    const auto ours = declared_modbus().protocol().size(request),
               theirs = built_in().protocol().size(request);
    ASSERT_EQ(ours.has_value(), theirs.has_value()) << i;
    if (!ours) continue;
    ++sent;
    EXPECT_EQ(ours->request_characters, theirs->request_characters);
    EXPECT_EQ(ours->response_characters, theirs->response_characters);
    const Bytes bytes = declared_modbus().request_bytes(request);
    ASSERT_EQ(to_hex(bytes), to_hex(built_in().request_bytes(request)));
    ASSERT_EQ(bytes.size(), ours->request_characters);
  }
  EXPECT_GT(sent, 5000u);
}

// Exchanges to compare; the second stage compares a million.
unsigned exchanges() {
  const char* text = std::getenv("FIELDCAST_EXCHANGES");
  return text == nullptr ? 10'000 : static_cast<unsigned>(std::strtoul(text, nullptr, 10));
}

TEST(DeclaredModbus, UnderstandsWhatTheBuiltInOneUnderstands) {
  Requests requests(2);
  std::mt19937 random(3);
  for (unsigned compared = 0; compared < exchanges() && !HasFailure();) {
    const Request request = requests.next();
    if (!built_in().protocol().size(request)) continue;
    compared += 6;
    const Bytes sent = built_in().request_bytes(request);
    const Bytes right = answer_to(sent, random);
    expect_same(request, right, "right");

    Bytes refused{kUnit, static_cast<std::uint8_t>(sent[1] | 0x80),
                  static_cast<std::uint8_t>(random() % 12)};
    append_crc(refused);
    expect_same(request, refused, "exception");

    Bytes foreign = right;
    foreign[0] = 18;
    foreign.resize(foreign.size() - 2);
    append_crc(foreign);
    expect_same(request, foreign, "of another unit");
    foreign.insert(foreign.end(), right.begin(), right.end());
    expect_same(request, foreign, "behind that of another unit");

    expect_same(
        request,
        Bytes(right.begin(), right.begin() + static_cast<std::ptrdiff_t>(random() % right.size())),
        "cut");
    Bytes flipped = right;
    flipped[random() % flipped.size()] ^= static_cast<std::uint8_t>(1u << random() % 8);
    expect_same(request, flipped, "flipped", false);
  }
}

TEST(DeclaredModbus, TheMatrixHolds) {
  const Device& device = declared_modbus();
  const std::pair<std::string, std::uint32_t> reads[] = {
      {"coil:3", 19}, {"holding:100", 5}, {"input-register:7", 1}};
  std::mt19937 random(5);
  for (const auto& [at, count] : reads) {
    const Request request = device.read(at, count);
    const MatrixCase matrix{.begin = [&] { return device.begin(request); },
                            .answers = {answer_to(device.request_bytes(request), random)}};
    expect_matrix(matrix);
    expect_random_bytes_are_refused(matrix, 6, 2000);
  }
  for (const auto& request : {device.write("coil:5", "01"), device.write("holding:1", "1234"),
                              device.write("holding:1", "12345678")}) {
    expect_matrix({.begin = [&] { return device.begin(request); },
                   .answers = {answer_to(device.request_bytes(request), random)}});
  }
  const Request request = device.read("holding:100", 5);
  Bytes refusal{kUnit, 0x83, 2};
  append_crc(refusal);
  expect_matrix({.begin = [&] { return device.begin(request); }, .answers = {refusal}});
}

TEST(DeclaredModbus, ItsTraitsComeFromItsFrames) {
  const Traits& traits = declared_modbus().protocol().traits();
  EXPECT_EQ(traits.identity, ResponseIdentity::kAddress);
  EXPECT_TRUE(traits.echo_is_ambiguous);
  ASSERT_EQ(declared_modbus().protocol().areas().size(), 4u);
  for (std::size_t i = 0; i < 4; ++i) {
    const Area &ours = declared_modbus().protocol().areas()[i],
               &theirs = built_in().protocol().areas()[i];
    EXPECT_EQ(ours.name, theirs.name);
    EXPECT_EQ(ours.item_bits, theirs.item_bits);
    EXPECT_EQ(ours.items, theirs.items);
    EXPECT_EQ(ours.max_read, theirs.max_read);
    EXPECT_EQ(ours.max_write, theirs.max_write);
    EXPECT_EQ(ours.writable, theirs.writable);
  }
}

}  // namespace
}  // namespace fieldcast::test
