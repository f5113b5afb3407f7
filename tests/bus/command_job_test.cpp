#include "core/bus/command/command_job.hpp"

#include <gtest/gtest.h>

#include <array>

#include "tests/bus/command_job_fixture.hpp"

namespace fieldcast {
namespace {

TEST_F(CommandJobTest, WriteIsDoneWhenTheDeviceConfirms) {
  auto job = make(write("setpoint", std::uint64_t{500}));
  ASSERT_TRUE(job);
  const auto request = job->next();
  EXPECT_EQ(std::get<WriteRequest>(*request).items, (Bytes{0x01, 0xF4}));
  job->responded({{}}, {});
  EXPECT_FALSE(job->next());
  EXPECT_EQ(result(*job).state, CommandState::kDone);
  EXPECT_EQ(job->written_channel(), ChannelIndex{10});
}

TEST_F(CommandJobTest, TextIsWrittenInTheCharacterSetOfTheChannel) {
  add("label", {2, 200, 2},
      {.type = ValueType::kString, .string_bytes = 4, .charset = Charset::kLatin1},
      Access::kReadWrite);
  const auto job = make(write("label", std::string("Kühl"), true));
  ASSERT_TRUE(job) << job.error().reason;
  EXPECT_EQ(std::get<WriteRequest>(*job->next()).items, (Bytes{0x4B, 0xFC, 0x68, 0x6C}));
  const auto reason = [&](const std::string& text) {
    const auto refused = make(write("label", text));
    EXPECT_EQ(refused.error().cause, Cause::kRange);
    return refused.error().reason;
  };
  EXPECT_EQ(reason("5 €"), "'5 €' has a character that latin-1 does not have");
  EXPECT_EQ(reason("\xE4\n"), "'\\xE4\\x0A' is no UTF-8");
  EXPECT_EQ(reason("Kühle"), "'Kühle' does not fit string(4)");
}

TEST_F(CommandJobTest, AValueThatMeansNotAvailableIsNotWritten) {
  Encoding encoding{.type = ValueType::kInt16};
  encoding.not_available = {0x8000};
  add("level", {2, 200, 1}, encoding, Access::kReadWrite);
  const auto refused = make(write("level", std::int64_t{-32768}));
  EXPECT_EQ(refused.error().cause, Cause::kRange);
  EXPECT_EQ(refused.error().reason,
            "-32768 means 'not available' at this channel (key 'not-available'); write another "
            "value");
  EXPECT_EQ(make(write("level", std::int64_t{-32769})).error().reason, "-32769 does not fit int16");
}

TEST_F(CommandJobTest, VerifyReadsBack) {
  auto job = make(write("setpoint", std::uint64_t{500}, true));
  job->responded({{}}, {});
  ASSERT_TRUE(std::holds_alternative<ReadRequest>(*job->next()));
  job->responded(items({0x01, 0xF4}), {});
  EXPECT_EQ(result(*job).state, CommandState::kVerified);
  EXPECT_EQ(result(*job).values, (std::vector<Value>{std::uint64_t{500}}));
}

TEST_F(CommandJobTest, AnotherValueReadBackIsAFailure) {
  auto job = make(write("setpoint", std::uint64_t{500}, true));
  job->responded({{}}, {});
  job->responded(items({0x00, 0x01}), {});
  EXPECT_EQ(result(*job).state, CommandState::kFailed);
  EXPECT_EQ(result(*job).cause, Cause::kNotVerified);
}

TEST_F(CommandJobTest, AWriteWithoutResponseIsReadBackNotRepeated) {
  auto job = make(write("setpoint", std::uint64_t{500}));
  job->failed(Cause::kNoResponse, 0);
  ASSERT_TRUE(std::holds_alternative<ReadRequest>(*job->next()));
  job->responded(items({0x01, 0xF4}), {});
  EXPECT_EQ(result(*job).state, CommandState::kDone);
}

TEST_F(CommandJobTest, WriteThatDidNotTakeEffectIsRepeatedWithinTheRetries) {
  auto job = make(write("setpoint", std::uint64_t{500}));
  job->failed(Cause::kNoResponse, 0);
  job->responded(items({0x00, 0x00}), {});
  ASSERT_TRUE(std::holds_alternative<WriteRequest>(*job->next()));
  job->failed(Cause::kNoResponse, 0);
  job->responded(items({0x00, 0x00}), {});
  EXPECT_EQ(result(*job).state, CommandState::kFailed);
  EXPECT_EQ(result(*job).cause, Cause::kNoResponse);
}

TEST_F(CommandJobTest, SilenceAfterAWriteWithoutResponseLeavesItOpen) {
  auto job = make(write("setpoint", std::uint64_t{500}));
  job->failed(Cause::kNoResponse, 0);
  job->failed(Cause::kNoResponse, 0);
  EXPECT_EQ(result(*job).state, CommandState::kFailed);
  EXPECT_EQ(result(*job).reason, "no response; unknown whether the write took effect");
}

TEST_F(CommandJobTest, RefusedWriteIsNotRepeated) {
  auto job = make(write("setpoint", std::uint64_t{500}));
  job->failed(Cause::kDeviceError, 4);
  EXPECT_FALSE(job->next());
  EXPECT_EQ(result(*job).cause, Cause::kDeviceError);
  EXPECT_EQ(result(*job).device_code, 4);
  EXPECT_EQ(result(*job).reason, "refused by the device (04 server device failure)");
}

TEST_F(CommandJobTest, AMomentaryCodeAfterWhichAWriteMayHaveTakenEffectIsReadBack) {
  for (const auto code : std::array<std::uint16_t, 3>{0x04, 0x05, 0x0B}) {
    for (const bool same : {true, false}) {
      auto job = make(write("setpoint", std::uint64_t{500}));
      job->failed(Cause::kDeviceBusy, code);
      const auto request = job->next();
      ASSERT_TRUE(request && std::holds_alternative<ReadRequest>(*request)) << code;
      job->responded(items(same ? Bytes{0x01, 0xF4} : Bytes{0x00, 0x01}), {});
      EXPECT_FALSE(job->next()) << "it is not written again";
      const auto ended = result(*job);
      EXPECT_EQ(ended.state, same ? CommandState::kDone : CommandState::kFailed);
      EXPECT_EQ(ended.device_code, same ? 0 : code);
      EXPECT_NE(ended.reason.find(same ? "; reading back shows the value"
                                       : "; reading back shows a different value"),
                std::string::npos)
          << ended.reason;
    }
  }
}

TEST_F(CommandJobTest, AMomentaryCodeBeforeTheWriteFailsImmediately) {
  for (const auto code : std::array<std::uint16_t, 2>{0x06, 0x0A}) {
    auto job = make(write("setpoint", std::uint64_t{500}));
    job->failed(Cause::kDeviceBusy, code);
    EXPECT_FALSE(job->next());
    const auto ended = result(*job);
    EXPECT_EQ(ended.state, CommandState::kFailed);
    EXPECT_EQ(ended.cause, Cause::kDeviceBusy);
    EXPECT_EQ(ended.reason.find("effect"), std::string::npos) << ended.reason;
  }
}

TEST_F(CommandJobTest, AMomentaryCodeToAWriteThatCannotBeReadBackLeavesItOpen) {
  device_.channels[0].access = Access::kWriteOnly;
  auto job = make(write("setpoint", std::uint64_t{500}));
  ASSERT_TRUE(job);
  job->failed(Cause::kDeviceBusy, 0x0B);
  EXPECT_FALSE(job->next());
  const auto ended = result(*job);
  EXPECT_EQ(ended.state, CommandState::kFailed);
  EXPECT_EQ(ended.device_code, 0x0B);
  EXPECT_NE(ended.reason.find("unknown whether the write took effect"), std::string::npos)
      << ended.reason;
}

TEST_F(CommandJobTest, BitOfAWordKeepsTheOtherBits) {
  auto job = make(write("lamp", true));
  ASSERT_TRUE(std::holds_alternative<ReadRequest>(*job->next()));
  job->responded(items({0xA0, 0x51}), {});
  EXPECT_EQ(std::get<WriteRequest>(*job->next()).items, (Bytes{0xA0, 0x59}));
  job->responded({{}}, {});
  EXPECT_EQ(result(*job).state, CommandState::kDone);
}

TEST_F(CommandJobTest, AVerifiedBitIsComparedAlone) {
  Encoding high{ValueType::kBool};
  high.bit = 11;
  add("fan", {2, 103, 1}, high, Access::kReadWrite);
  const auto state = [&](const std::string& channel, const Bytes& read_back) {
    auto job = make(write(channel, true, true));
    job->responded(items({0xA0, 0x51}), {});
    job->responded({{}}, {});
    job->responded(items(read_back), {});
    return result(*job).state;
  };
  EXPECT_EQ(state("lamp", {0x00, 0x08}), CommandState::kVerified);
  EXPECT_EQ(state("lamp", {0xA8, 0x51}), CommandState::kFailed);
  EXPECT_EQ(state("fan", {0x08, 0x00}), CommandState::kVerified);
  EXPECT_EQ(state("fan", {0xA0, 0x59}), CommandState::kFailed);
}

TEST_F(CommandJobTest, BitOfAWordIsOneRequestWhereTheDeviceMasks) {
  protocol_ = std::move(*find_protocol("modbus-rtu")->make({1, {{"mask-write", "true"}}}));
  auto job = make(write("lamp", true));
  EXPECT_EQ(std::get<WriteRequest>(*job->next()).bit, 3);
}

TEST_F(CommandJobTest, ARefusedFormIsFollowedByThePlainOneOnce) {
  const auto function = [&](const CommandJob& job) {
    Bytes frame;
    (void)protocol_->begin(*job.next(), {})->start(frame);
    return frame[1];
  };
  auto job = make(write("setpoint", std::uint64_t{5}));
  job->use_distinct_responses();
  EXPECT_EQ(function(*job), 16);
  job->failed(Cause::kDeviceError, 1);
  ASSERT_TRUE(job->next());
  EXPECT_EQ(function(*job), 6);
  job->failed(Cause::kDeviceError, 2);
  EXPECT_FALSE(job->next());
  EXPECT_EQ(result(*job).device_code, 2);
  EXPECT_EQ(result(*job).state, CommandState::kFailed);
}

TEST_F(CommandJobTest, EachFaultHasItsCause) {
  EXPECT_EQ(make(write("speed", std::uint64_t{1})).error().cause, Cause::kReadOnly);
  EXPECT_EQ(make(write("nothing", std::uint64_t{1})).error().cause, Cause::kUnknownChannel);
  EXPECT_EQ(make(write("setpoint", std::string{"x"})).error().cause, Cause::kWrongType);
  EXPECT_EQ(make(write("setpoint", std::uint64_t{70000})).error().cause, Cause::kRange);
  EXPECT_EQ(make(write("setpoint", std::uint64_t{1001})).error().cause, Cause::kRange);
  Command raw = write("", std::uint64_t{1});
  raw.target = AddressTarget{"holding:5", {}};
  EXPECT_EQ(make(raw).error().cause, Cause::kRawNotAllowed);
  device_.allow_raw_write = true;
  EXPECT_TRUE(make(raw));
  raw.target = AddressTarget{"holding:99999", {}};
  EXPECT_EQ(make(raw).error().cause, Cause::kBadAddress);
  raw.target = AddressTarget{"input-register:5", {}};
  EXPECT_EQ(make(raw).error().cause, Cause::kReadOnly);
}

TEST_F(CommandJobTest, AWriteNamesWhatCannotBeWritten) {
  const auto reason = [&](const std::string& channel, Value value) {
    const auto job = make(write(channel, std::move(value)));
    return job ? "taken" : job.error().reason;
  };
  Encoding bit{ValueType::kBool}, high{ValueType::kUint8};
  bit.bit = 3;
  high.bit = 8;
  add("start", {2, 110, 1}, bit, Access::kWriteOnly);
  add("high", {2, 111, 1}, high, Access::kReadWrite);
  device_.channels.own().back().at = "holding:111.high";
  EXPECT_EQ(reason("start", true), "a bit of a word that cannot be read cannot be written");
  EXPECT_EQ(reason("high", std::uint64_t{7}),
            "a byte of 'holding:111.high' cannot be written without the rest of it");
  device_.channels.own().erase(device_.channels.own().begin() + 1);  // the read-only one
  EXPECT_EQ(reason("", true), "a write needs a channel or an address");
}

TEST_F(CommandJobTest, APartOfAResponseMayBeRefusedOrHaveNoValue) {
  Command command;
  command.operation = Operation::kAcquire;
  command.device = "press";
  command.target = ChannelTarget{"speed"};
  auto job = make(command);
  ASSERT_TRUE(job);
  auto other = *job;
  job->responded({{Cause::kDeviceError, 2, {}}}, {});
  EXPECT_EQ(result(*job).cause, Cause::kDeviceError);
  EXPECT_EQ(result(*job).device_code, 2);
  other.responded({{Cause::kNone, 0, {0, 7}, {{2, 101, 1}}}}, {});
  EXPECT_EQ(result(other).cause, Cause::kNotAvailable);
}

TEST_F(CommandJobTest, ARawValueThatMeansNoneIsNotAvailable) {
  Encoding encoding{.type = ValueType::kInt16};
  encoding.not_available = {0x8000};
  add("level", {2, 200, 1}, encoding, Access::kReadOnly);
  Command command;
  command.operation = Operation::kAcquire;
  command.device = "press";
  command.target = ChannelTarget{"level"};
  auto job = make(command);
  job->responded(items({0x80, 0x00}), {});
  EXPECT_EQ(result(*job).cause, Cause::kNotAvailable);
  EXPECT_EQ(result(*job).reason, to_text(Cause::kNotAvailable));
}

TEST_F(CommandJobTest, AFailureNamesWhatWasSeenInPlaceOfAResponse) {
  Command command;
  command.operation = Operation::kAcquire;
  command.device = "press";
  command.target = ChannelTarget{"speed"};
  auto job = make(command);
  job->failed(Cause::kChecksum, 0, "01 03 02");
  EXPECT_EQ(result(*job).reason, std::string(to_text(Cause::kChecksum)) + "; 01 03 02");
}

// A device may format the same number in another way, and a broken one sends none.
TEST_F(CommandJobTest, ANumberAsTextIsVerifiedByItsValue) {
  add("target", {2, 200, 3},
      {.type = ValueType::kFloat32,
       .string_bytes = 6,
       .text_number = {.kind = TextNumber::Kind::kDecimal}},
      Access::kReadWrite);
  const auto state = [&](std::string_view text) {
    auto job = make(write("target", 25.0, true));
    job->responded({{}}, {});
    job->responded(items(Bytes(text.begin(), text.end())), {});
    return result(*job).state;
  };
  EXPECT_EQ(state("+25.00"), CommandState::kVerified);
  EXPECT_EQ(state("  25.0"), CommandState::kVerified);
  EXPECT_EQ(state("  26.0"), CommandState::kFailed);
  EXPECT_EQ(state("------"), CommandState::kFailed);
}

TEST_F(CommandJobTest, AReadAfterAWriteThatIsRefusedIsSaidSo) {
  auto job = make(write("setpoint", std::uint64_t{500}, true));
  job->use_distinct_responses();
  job->responded({{}}, {});
  job->failed(Cause::kDeviceError, 2);
  EXPECT_FALSE(job->next());
  EXPECT_TRUE(result(*job).reason.starts_with("written, but reading back failed: "));
}

TEST_F(CommandJobTest, OnlyAWriteOfWhatIsReadableIsReadFirst) {
  add("start", {2, 110, 1}, {}, Access::kWriteOnly);
  const auto first = [&](const Command& command) {
    auto job = make(command);
    job->read_first();
    return *job->next();
  };
  EXPECT_TRUE(std::holds_alternative<ReadRequest>(first(write("setpoint", std::uint64_t{5}))));
  EXPECT_TRUE(std::holds_alternative<WriteRequest>(first(write("start", std::uint64_t{5}))));
  Command acquire = write("speed", std::uint64_t{0});
  acquire.operation = Operation::kAcquire;
  auto job = make(acquire);
  job->read_first();
  job->responded(items({0, 7}), {});
  EXPECT_EQ(result(*job).state, CommandState::kDone);
}

TEST_F(CommandJobTest, WholeDeviceIsAcquiredInFewReads) {
  Command command;
  command.operation = Operation::kAcquire;
  command.device = "press";
  command.target = ChannelTarget{};
  auto job = make(command);
  ASSERT_TRUE(job);
  job->responded(items({1}), {});
  EXPECT_EQ(job->take_acquired().size(), 1u);
  EXPECT_TRUE(job->take_acquired().empty());
  job->responded(items({0x00, 0x05, 0x00, 0x06, 0x00, 0x08}), {});  // three adjacent registers
  EXPECT_FALSE(job->next());
  EXPECT_EQ(result(*job).values,
            (std::vector<Value>{std::uint64_t{5}, std::uint64_t{6}, true, true}));
  EXPECT_EQ(job->take_acquired().size(), 3u);
}

// Regression: a reason without the channel left it open which of many values is not a number.
TEST_F(CommandJobTest, AnAcquiredValueThatIsNoneIsNamed) {
  add("level", {2, 200, 2}, {ValueType::kFloat32}, Access::kReadOnly);
  Command command;
  command.operation = Operation::kAcquire;
  command.device = "press";
  const auto reason_of = [&](Target target, const Bytes& registers) {
    command.target = std::move(target);
    auto job = make(command);
    if (!job) return job.error().reason;
    while (const auto request = job->next()) {
      const Range& range = std::get<ReadRequest>(*request).ranges.front();
      job->responded(items(range.first >= 200 ? registers : Bytes(range.count * 2u)), {});
    }
    EXPECT_EQ(result(*job).state, CommandState::kFailed);
    EXPECT_EQ(result(*job).cause, Cause::kRange);
    return result(*job).reason;
  };
  const Bytes not_a_number{0x7F, 0xC0, 0, 0};
  EXPECT_EQ(reason_of(ChannelTarget{}, not_a_number),
            "channel 'level': the device holds no value of type float32");
  EXPECT_EQ(reason_of(ChannelTarget{"level"}, not_a_number),
            "the device holds no value of type float32");
  device_.allow_raw_read = true;
  command.count = 2;
  EXPECT_EQ(reason_of(AddressTarget{"holding:200", {ValueType::kFloat32}},
                      {0x3F, 0x80, 0, 0, 0x7F, 0xC0, 0, 0}),
            "value 2: the device holds no value of type float32");
}

TEST_F(CommandJobTest, NoReadIsLongerThanTheBlockOfTheDevice) {
  Command command;
  command.operation = Operation::kAcquire;
  command.device = "press";
  command.target = ChannelTarget{};
  device_.max_block = 2;
  auto job = make(command);
  ASSERT_TRUE(job);
  std::vector<Range> ranges;
  for (const std::size_t items : {1u, 4u, 2u}) {
    const auto request = job->next();
    ASSERT_TRUE(request);
    ranges.push_back(std::get<ReadRequest>(*request).ranges.front());
    job->responded(CommandJobTest::items(Bytes(items)), {});
  }
  EXPECT_FALSE(job->next());
  EXPECT_EQ(ranges, (std::vector<Range>{{0, 7, 1}, {2, 100, 2}, {2, 102, 1}}));
}

}  // namespace
}  // namespace fieldcast
