#include <gtest/gtest.h>

#include <map>

#include "tests/bus/command_job_fixture.hpp"

namespace fieldcast {
namespace {

// An S7-200 that allows commands to raw addresses.
class RawCommandTest : public CommandJobTest {
 protected:
  RawCommandTest() {
    device_.allow_raw_read = device_.allow_raw_write = true;
    use("s7-ppi");
  }
  void use(const char* protocol, std::map<std::string, std::string> options = {}) {
    protocol_ = std::move(*find_protocol(protocol)->make({1, std::move(options)}));
  }
  Command raw(const std::string& at, Encoding encoding, std::vector<Value> values) {
    Command command;
    command.device = "press";
    command.target = AddressTarget{at, encoding};
    command.values = std::move(values);
    return command;
  }
  Command raw_read(const std::string& at, Encoding encoding, std::uint32_t count) {
    Command command = raw(at, encoding, {});
    command.operation = Operation::kAcquire;
    command.count = count;
    return command;
  }
  std::string why_not(const Command& command) {
    const auto job = make(command);
    return job ? "taken" : job.error().reason;
  }
};

TEST_F(RawCommandTest, AWriteTouchesNoMoreThanTheAddressNames) {
  auto job = make(raw("VB10", {ValueType::kUint8}, {std::uint64_t{7}}));
  ASSERT_TRUE(job) << job.error().reason;
  const auto write = std::get<WriteRequest>(*job->next());
  EXPECT_EQ(write.range, (Range{0, 10, 1}));
  EXPECT_EQ(write.items, (Bytes{7}));
  EXPECT_EQ(why_not(raw("VB10", {ValueType::kUint16}, {std::uint64_t{7}})),
            "type uint16 has 16 bits, 'VB10' has 8; allowed: a type of 8 bits");
}

TEST_F(RawCommandTest, ACommandHasUpToAThousandValuesAndTwoThousandOfTheGateway) {
  use("modbus-rtu");
  const auto cause = [&](std::uint32_t count, bool gateway) {
    Command command = raw_read("holding:0", {}, count);
    command.gateway = gateway;
    const auto job = make(command);
    return job ? Cause::kNone : job.error().cause;
  };
  EXPECT_EQ(cause(1, false), Cause::kNone);
  EXPECT_EQ(cause(0, false), Cause::kRange);
  EXPECT_EQ(cause(1000, false), Cause::kNone);
  EXPECT_EQ(cause(1001, false), Cause::kRange);
  EXPECT_EQ(cause(2000, true), Cause::kNone);
  EXPECT_EQ(cause(2001, true), Cause::kRange);
}

TEST_F(RawCommandTest, SkippedValuesAreNotRead) {
  const auto range = [&](const char* at, ValueType type, std::uint32_t skip, std::uint32_t count) {
    Command command = raw_read(at, {type}, count);
    std::get<AddressTarget>(command.target).skip = skip;
    const auto job = make(command);
    return job ? std::get<ReadRequest>(*job->next()).ranges.front() : Range{0, 0, 0};
  };
  EXPECT_EQ(range("VW10", ValueType::kUint16, 3, 2), (Range{0, 16, 4}));
  EXPECT_EQ(range("VD10", ValueType::kFloat32, 1, 1), (Range{0, 14, 4}));
  EXPECT_EQ(range("V10.6", ValueType::kBool, 4, 1), (Range{0, 11, 1})) << "V11.2";
  EXPECT_EQ(range("VW10", ValueType::kUint16, UINT32_MAX, 1), (Range{0, 0, 0})) << "far beyond";
}

TEST_F(RawCommandTest, ATypeThatDoesNotFitTheAddressIsRejectedAsAChannelWouldBe) {
  using enum ValueType;
  EXPECT_EQ(make(raw_read("VW10", {kInt32}, 1)).error().cause, Cause::kWrongType);
  EXPECT_EQ(make(raw_read("VD10", {kUint16}, 1)).error().cause, Cause::kWrongType);
  EXPECT_EQ(make(raw_read("V10.3", {kUint8}, 1)).error().cause, Cause::kWrongType);
  EXPECT_EQ(make(raw_read("VB10", {kBool}, 1)).error().cause, Cause::kWrongType);
  Encoding far{kBool};
  far.bit = 8;
  EXPECT_EQ(make(raw_read("VB10", far, 1)).error().cause, Cause::kWrongType);
  EXPECT_EQ(make(raw_read("V10.3", far, 1)).error().cause, Cause::kWrongType) << "the bit twice";
  EXPECT_TRUE(make(raw_read("VD10", {kFloat32}, 1)));
  EXPECT_TRUE(make(raw_read("VB10", {kString, 20}, 1)));
  use("mitsubishi-fx");
  EXPECT_EQ(make(raw_read("D0", {kString, 250}, 1)).error().cause, Cause::kRange)
      << "more than one read carries";
  use("modbus-rtu");
  EXPECT_EQ(make(raw_read("holding:1", {kUint8}, 1)).error().cause, Cause::kWrongType);
}

TEST_F(RawCommandTest, EachRefusedWriteHasItsReason) {
  const Encoding bit{ValueType::kBool};
  EXPECT_EQ(why_not(raw("V10.6", bit, {true, false})), "bits of a word are written one at a time");
  use("modbus-rtu");
  const Encoding text{.type = ValueType::kString, .string_bytes = 250};
  EXPECT_EQ(why_not(raw("holding:0", text, {std::string("a")})),
            "'holding:0' needs 125 items in one write; allowed: at most 123");
  const std::vector<Value> many(124, Value{std::uint64_t{7}});
  EXPECT_EQ(why_not(raw("holding:0", {}, many)), "too many values for one request");
}

TEST_F(RawCommandTest, TheBitOfAnAddressMayBeNamedAgain) {
  Encoding third{ValueType::kBool};
  third.bit = 3;
  EXPECT_EQ(why_not(raw_read("V10.3", third, 1)), "taken");
}

TEST_F(RawCommandTest, AnOrderOfTheCommandHolds) {
  use("modbus-rtu");
  Encoding word{.type = ValueType::kUint32, .word_order = WordOrder::kLittleEndian};
  auto job = make(raw("holding:0", word, {std::uint64_t{0x12345678}}));
  EXPECT_EQ(std::get<WriteRequest>(*job->next()).items, (Bytes{0x56, 0x78, 0x12, 0x34}));
  Encoding text{.type = ValueType::kString, .string_bytes = 4};
  text.byte_order = ByteOrder::kLittleEndian;
  job = make(raw("holding:0", text, {std::string("abcd")}));
  EXPECT_EQ(std::get<WriteRequest>(*job->next()).items, (Bytes{'b', 'a', 'd', 'c'}));
}

// Function 23 carries two registers less than function 16.
TEST_F(RawCommandTest, AWriteTooLongToBeReadBackAtOnceIsReadBackAfterwards) {
  use("modbus-rtu", {{"read-write", "true"}});
  for (const std::size_t values : {121u, 123u}) {
    Command command = raw("holding:0", {}, std::vector<Value>(values, Value{std::uint64_t{7}}));
    command.verify = true;
    const auto job = make(command);
    ASSERT_TRUE(job) << job.error().reason;
    EXPECT_EQ(std::holds_alternative<WriteReadRequest>(*job->next()), values == 121u);
  }
}

TEST_F(RawCommandTest, NumbersAsTextAreReadBackOneByOneOnly) {
  use("modbus-rtu");
  const Encoding number{.type = ValueType::kFloat32,
                        .string_bytes = 6,
                        .text_number = {.kind = TextNumber::Kind::kDecimal}};
  Command command = raw("holding:0", number, {25.0, 26.0});
  command.verify = true;
  auto job = make(command);
  ASSERT_TRUE(job) << job.error().reason;
  job->responded({{}}, {});
  const std::string_view text = "+25.00+26.00";
  job->responded(items(Bytes(text.begin(), text.end())), {});
  EXPECT_EQ(result(*job).cause, Cause::kNotVerified);
}

TEST_F(RawCommandTest, CountIsValuesOfTheTypeOneBehindTheOther) {
  auto job = make(raw_read("VW10", {ValueType::kInt16}, 3));
  ASSERT_TRUE(job);
  EXPECT_EQ(std::get<ReadRequest>(*job->next()).ranges, (std::vector<Range>{{0, 10, 6}}));
  job->responded(items({0, 1, 0, 2, 0xFF, 0xFD}), {});
  EXPECT_EQ(result(*job).values,
            (std::vector<Value>{std::int64_t{1}, std::int64_t{2}, std::int64_t{-3}}));
  job = make(raw_read("VB10", {ValueType::kUint8}, 3));
  EXPECT_EQ(std::get<ReadRequest>(*job->next()).ranges, (std::vector<Range>{{0, 10, 3}}));
  EXPECT_FALSE(make(raw_read("VB10", {ValueType::kUint8}, kMaxRawValues + 1)));
}

TEST_F(RawCommandTest, BitsFollowEachOther) {
  auto job = make(raw_read("V10.6", {ValueType::kBool}, 4));
  ASSERT_TRUE(job) << job.error().reason;
  EXPECT_EQ(std::get<ReadRequest>(*job->next()).ranges, (std::vector<Range>{{0, 10, 2}}));
  job->responded(items({0x80, 0x01}), {});  // V10.7 and V11.0
  EXPECT_EQ(result(*job).values, (std::vector<Value>{false, true, true, false}));
}

TEST_F(RawCommandTest, AValueStaysWithinItsBank) {
  use("modbus-rtu");
  auto job = make(raw_read("file:4:9998", {ValueType::kUint32}, 2));
  ASSERT_TRUE(job) << job.error().reason;
  const auto next_range = [&] { return std::get<ReadRequest>(*job->next()).ranges; };
  EXPECT_EQ(next_range(), (std::vector<Range>{{4, 49998, 2}}));
  job->responded(items({0, 0, 0, 1}), {});
  EXPECT_EQ(next_range(), (std::vector<Range>{{4, 50000, 2}})) << "values go on in the next file";
  const std::string fault = "'file:4:9999' reaches beyond its bank of the area";
  EXPECT_EQ(why_not(raw_read("file:4:9999", {ValueType::kUint32}, 1)), fault);
  EXPECT_EQ(why_not(raw("file:4:9999", {ValueType::kUint32}, {std::uint64_t{7}})), fault);
}

TEST_F(RawCommandTest, AByteOfARegisterIsWrittenByAMaskOrNotAtAll) {
  Encoding high{ValueType::kUint8};
  high.bit = 8;
  use("modbus-rtu");
  EXPECT_EQ(why_not(raw("holding:5", high, {std::uint64_t{7}})),
            "a byte of 'holding:5' cannot be written without the rest of it");
  use("modbus-rtu", {{"mask-write", "true"}});
  Command command = raw("holding:5", high, {std::uint64_t{0x1C}});
  command.verify = true;
  auto job = make(command);
  ASSERT_TRUE(job) << job.error().reason;
  const auto request = *job->next();
  ASSERT_TRUE(protocol_->size(request));
  Bytes frame;
  (void)protocol_->begin(request, {})->start(frame);
  EXPECT_EQ(to_hex(ByteView(frame).first(8)), to_hex(*from_hex("01 16 00 05 00 FF 1C 00")));
  job->responded({{}}, {});
  job->responded(items({0x1C, 0x99}), {});  // the other byte is not part of the command
  EXPECT_EQ(result(*job).state, CommandState::kVerified);
  EXPECT_EQ(result(*job).values, (std::vector<Value>{std::uint64_t{0x1C}}));
}

TEST_F(RawCommandTest, BytesOfAnItemAreReadOneAtATime) {
  Encoding high{ValueType::kUint8};
  high.bit = 8;
  use("modbus-rtu");
  EXPECT_TRUE(make(raw_read("holding:5", high, 1)));
  for (const std::uint32_t count : {2u, 3u})
    EXPECT_EQ(why_not(raw_read("holding:5", high, count)),
              "bytes of an item are read and written one at a time");
}

TEST_F(RawCommandTest, BitsOfAMaskAreOneRequestAndReadBackAlone) {
  use("modbus-rtu");
  Command command = raw("holding:5", {ValueType::kUint16}, {std::uint64_t{0x25}});
  command.mask = 0x000F;
  command.verify = true;
  auto job = make(command);
  ASSERT_TRUE(job) << job.error().reason;
  EXPECT_FALSE(job->batchable());
  const auto write = std::get<WriteRequest>(*job->next());
  EXPECT_EQ(write.mask, 0x000F);
  Bytes frame;
  (void)protocol_->begin(write, {})->start(frame);
  EXPECT_EQ(to_hex(ByteView(frame).first(8)), "01 16 00 05 FF F0 00 25");
  job->responded({{}}, {});
  EXPECT_TRUE(std::holds_alternative<ReadRequest>(*job->next()));
  auto other = *job;
  job->responded(items({0x12, 0x35}), {});
  EXPECT_EQ(result(*job).state, CommandState::kVerified) << "the other bits are those of before";
  other.responded(items({0x00, 0x24}), {});
  EXPECT_EQ(result(other).cause, Cause::kNotVerified);
}

TEST_F(RawCommandTest, AProtocolWithoutMasksRejectsThem) {
  const std::pair<const char*, const char*> kRejected[] = {
      {"omron-hostlink", "DM5"}, {"modbus-rtu", "file:4:1"}, {"modbus-rtu", "coil:4"}};
  for (const auto& [protocol, at] : kRejected) {
    use(protocol);
    const bool bits = std::string_view(at).starts_with("coil");
    Command command = bits ? raw(at, {ValueType::kBool}, {true})
                           : raw(at, {ValueType::kUint16}, {std::uint64_t{0x25}});
    command.mask = 0x000F;
    EXPECT_EQ(why_not(command), "this protocol writes no bits by a mask") << at;
  }
  Command two = raw("holding:5", {ValueType::kUint16}, {std::uint64_t{1}, std::uint64_t{2}});
  two.mask = 1;
  EXPECT_EQ(why_not(two), "this protocol writes no bits by a mask");
}

TEST_F(RawCommandTest, ADateIsATextOfItsAddress) {
  use("s7-tcp");
  const Encoding text{.type = ValueType::kString, .string_bytes = 29};
  auto job = make(raw("DB1.DTL4", text, {std::string("2026-11-28T10:15:00.5")}));
  ASSERT_TRUE(job) << job.error().reason;
  EXPECT_EQ(std::get<WriteRequest>(*job->next()).range, (Range{0, 4, 12}));
  EXPECT_EQ(to_hex(std::get<WriteRequest>(*job->next()).items),
            "07 EA 0B 1C 07 0A 0F 00 1D CD 65 00");
  EXPECT_EQ(why_not(raw("DB1.DTL4", text, {std::string("2026-13-28T10:15:00")})),
            "'2026-13-28T10:15:00' does not fit a date and time like 2026-11-28T10:15:00.000");
  EXPECT_EQ(why_not(raw("DB1.DT4", text, {std::string("2026-11-28T10:15:00")})),
            "type string(29) at 'DB1.DT4', which is a date; allowed: string(23)");
  job = make(raw_read("DB1.DTL4", text, 1));
  ASSERT_TRUE(job) << job.error().reason;
  job->responded(items({0x07, 0xEA, 13, 1, 1, 0, 0, 0, 0, 0, 0, 0}), {});
  EXPECT_EQ(result(*job).state, CommandState::kFailed) << "month 13";
  EXPECT_EQ(result(*job).cause, Cause::kRange);
}

TEST_F(RawCommandTest, TheOrderOfTheFamilyHolds) {
  use("mitsubishi-fx");
  auto job = make(raw("D0", {ValueType::kUint32}, {std::uint64_t{0x12345678}}));
  EXPECT_EQ(std::get<WriteRequest>(*job->next()).items, (Bytes{0x56, 0x78, 0x12, 0x34}));
  job = make(raw("D0", {ValueType::kString, 4}, {std::string("abcd")}));
  EXPECT_EQ(std::get<WriteRequest>(*job->next()).items, (Bytes{'b', 'a', 'd', 'c'}));
  use("omron-hostlink");
  job = make(raw("DM0", {ValueType::kUint32}, {std::uint64_t{0x12345678}}));
  EXPECT_EQ(std::get<WriteRequest>(*job->next()).items, (Bytes{0x56, 0x78, 0x12, 0x34}));
}

TEST_F(CommandJobTest, AddressesAreAcquiredAsOftenAsAsked) {
  device_.allow_raw_read = true;
  Command command;
  command.operation = Operation::kAcquire;
  command.device = "press";
  command.target = AddressTarget{"holding:200", {}};
  command.count = 300;
  auto job = make(command);
  ASSERT_TRUE(job);
  std::size_t reads = 0;
  while (const auto request = job->next()) {
    const Range range = std::get<ReadRequest>(*request).ranges.front();
    job->responded(items(Bytes(2 * range.count, 0)), {});
    ++reads;
  }
  EXPECT_EQ(reads, 3u);
  EXPECT_EQ(result(*job).values.size(), 300u);
}

}  // namespace
}  // namespace fieldcast
