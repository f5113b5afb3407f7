#include "bridge/dds/topics/conversion.hpp"

#include <gtest/gtest.h>

#include <limits>

namespace fieldcast {
namespace {

using namespace std::chrono_literals;

Instant at(Duration since_start) { return Instant{since_start}; }
const UtcMapping kMapping{at(100s), {1'700'000'000'000'000'000}};

TEST(UtcMapping, DistancesAreKeptAndNoTimeIsZero) {
  EXPECT_EQ(kMapping.to_utc(at(101s)).nanoseconds, 1'700'000'001'000'000'000);
  EXPECT_EQ(kMapping.to_utc(at(99s)).nanoseconds, 1'699'999'999'000'000'000);
  EXPECT_EQ(kMapping.to_utc(kLongAgo), UtcTime{});
  EXPECT_EQ(kMapping.to_utc(kNever), UtcTime{});
}

TEST(UtcMapping, SaturatesInsteadOfWrapping) {
  EXPECT_EQ(kMapping.to_utc(Instant{Duration{INT64_MAX - 1}}).nanoseconds, INT64_MAX);
  EXPECT_EQ(kMapping.to_utc(Instant{Duration{INT64_MIN + 1}}).nanoseconds, INT64_MIN);
}

TEST(ValueConversion, EveryKindComesBackAsItWas) {
  const Value values[] = {true,
                          false,
                          std::int64_t{-5},
                          std::numeric_limits<std::int64_t>::min(),
                          std::numeric_limits<std::uint64_t>::max(),
                          2.5,
                          std::string{},
                          std::string("Öl 80 °C"),
                          std::string(kMaxTextValue, 'x')};
  idl::Value topic;  // shared, so that a stale kind is detected
  for (const Value& value : values) {
    ASSERT_TRUE(to_idl(value, topic)) << to_text(value);
    EXPECT_EQ(from_idl(topic), value) << to_text(value);
  }
}

TEST(ValueConversion, TooLongATextIsRefused) {
  idl::Value topic;
  EXPECT_FALSE(to_idl(std::string(kMaxTextValue + 1, 'x'), topic));
  EXPECT_FALSE(to_idl(std::string("a\0b", 3), topic));
}

// Makes a value of a kind that the IDL does not name, as the generated code of each Fast DDS does
// when it reads one.
template <class Union>
void make_unknown(Union& value) {
  if constexpr (requires { value._default(); })
    value._default();
  else
    value._d() = static_cast<idl::ValueKind>(99);
}

TEST(ValueConversion, AnUnknownKindHasNoValue) {
  idl::Value topic;
  make_unknown(topic);
  EXPECT_EQ(from_idl(topic), std::nullopt);
}

TEST(SampleConversion, ComesBackWithUtcTime) {
  Sample sample{.channel = 7,
                .value = 2.5,
                .quality = Quality::kBadDeviceError,
                .device_code = 2,
                .acquired = at(98s),
                .sequence = 42};
  idl::Sample topic;
  topic.bus() = "b";
  topic.device() = "d";
  topic.channel() = "c";
  to_idl(sample, kMapping, topic);
  const auto back = from_idl(topic);
  ASSERT_TRUE(back);
  EXPECT_EQ(back->bus + "/" + back->device + "/" + back->channel, "b/d/c");
  EXPECT_EQ(back->value, Value{2.5});
  EXPECT_EQ(back->quality, Quality::kBadDeviceError);
  EXPECT_EQ(back->device_code, 2);
  EXPECT_EQ(back->acquired_at.nanoseconds, 1'699'999'998'000'000'000);
  EXPECT_EQ(back->sequence, 42u);
}

TEST(SampleConversion, TextBeyondTheBoundIsBadAndEmptyNeverShortened) {
  idl::Sample topic;
  to_idl(Sample{.value = std::string(300, 'x'), .quality = Quality::kGood}, kMapping, topic);
  const auto back = from_idl(topic);
  ASSERT_TRUE(back);
  EXPECT_EQ(back->quality, Quality::kBadRange);
  EXPECT_EQ(back->value, Value{std::string{}});
}

TEST(SampleConversion, UnknownQualityIsRefused) {
  idl::Sample topic;
  topic.quality(static_cast<idl::Quality>(77));
  EXPECT_FALSE(from_idl(topic));
}

TEST(ChannelConversion, SaysWhatTheConfigurationSays) {
  DeviceSpec device;
  device.name = "press-1";
  ChannelSpec channel;
  channel.name = "oil-temperature";
  channel.at = "holding:100";
  channel.encoding.type = ValueType::kString;
  channel.encoding.string_bytes = 16;
  channel.unit = "°C";
  channel.description = "in the sump";
  channel.access = Access::kReadWrite;
  channel.mode = Mode::kIntensive;
  channel.limits.high = 80.0;
  channel.limits.low_low = -5.0;
  channel.write_max = 60.0;
  idl::Channel topic;
  to_idl("line-7", "press-shop", device, channel, 500ms, topic);
  const StationChannel back = from_idl(topic);
  EXPECT_EQ(back.bridge, "line-7");
  EXPECT_EQ(back.bus + "/" + back.device + "/" + back.channel,
            "press-shop/press-1/oil-temperature");
  EXPECT_EQ(back.type, "string(16)");
  EXPECT_EQ(back.at, "holding:100");
  EXPECT_EQ(back.unit, "°C");
  EXPECT_EQ(back.description, "in the sump");
  EXPECT_EQ(back.access, Access::kReadWrite);
  EXPECT_EQ(back.mode, Mode::kIntensive);
  EXPECT_EQ(back.refresh, 500ms);
  EXPECT_EQ(back.limits, channel.limits);
  EXPECT_EQ(back.write_min, std::nullopt);
  EXPECT_EQ(back.write_max, 60.0);
  to_idl("line-7", "press-shop", device, channel, std::nullopt, topic);
  EXPECT_EQ(from_idl(topic).refresh, Duration::zero());
}

TEST(CutText, NeverCutsACharacter) {
  EXPECT_EQ(cut_text("abc", 3), "abc");
  EXPECT_EQ(cut_text("ab°", 3), "ab");  // ° is two bytes
  EXPECT_EQ(cut_text("ab°", 4), "ab°");
  EXPECT_EQ(cut_text(std::string_view("a\0b", 3), 9), "a");
}

Command some_command() {
  Command command;
  command.requester = "station:1";
  command.request_id = 9;
  command.device = "press-1";
  command.target = ChannelTarget{"running"};
  command.values = {true};
  command.verify = true;
  return command;
}

TEST(CommandConversion, ChannelWriteComesBack) {
  idl::Command topic;
  ASSERT_TRUE(to_idl("press-shop", some_command(), topic));
  EXPECT_STREQ(topic.bus().c_str(), "press-shop");
  const auto back = from_idl(topic);
  ASSERT_TRUE(back) << back.error().reason;
  EXPECT_EQ(back->requester, "station:1");
  EXPECT_EQ(back->request_id, 9u);
  EXPECT_EQ(back->device, "press-1");
  EXPECT_EQ(std::get<ChannelTarget>(back->target).name, "running");
  EXPECT_EQ(back->operation, Operation::kWrite);
  EXPECT_EQ(back->values, std::vector<Value>{true});
  EXPECT_TRUE(back->verify);
}

TEST(CommandConversion, AddressWithItsEncodingComesBack) {
  Command command = some_command();
  Encoding encoding;
  encoding.type = ValueType::kBool;
  encoding.bit = 12;
  encoding.word_order = WordOrder::kLittleEndian;
  encoding.byte_order = ByteOrder::kLittleEndian;
  encoding.scale = 0.1;
  encoding.offset = -40;
  command.target = AddressTarget{"DM100", encoding};
  command.operation = Operation::kAcquire;
  command.values.clear();
  command.count = 12;
  idl::Command topic;
  ASSERT_TRUE(to_idl("b", command, topic));
  const auto back = from_idl(topic);
  ASSERT_TRUE(back) << back.error().reason;
  EXPECT_EQ(std::get<AddressTarget>(back->target).at, "DM100");
  EXPECT_EQ(std::get<AddressTarget>(back->target).encoding, encoding);
  EXPECT_EQ(back->operation, Operation::kAcquire);
  EXPECT_EQ(back->count, 12u);
}

TEST(CommandConversion, WhatDoesNotFitIsNotSent) {
  idl::Command topic;
  Command command = some_command();
  command.device = std::string(65, 'x');
  EXPECT_FALSE(to_idl("b", command, topic));
  command = some_command();
  command.values.assign(kMaxCommandValues + 1, Value{true});
  EXPECT_FALSE(to_idl("b", command, topic));
  command = some_command();
  command.values = {std::string(300, 'x')};
  EXPECT_FALSE(to_idl("b", command, topic));
}

TEST(CommandConversion, EveryMalformationHasItsCause) {
  struct Case {
    Cause cause;
    std::function<void(idl::Command&)> damage;
  };
  const auto to_address = [](idl::Command& c) { c.target_kind(idl::TargetKind::TARGET_ADDRESS); };
  const Case cases[] = {
      {Cause::kUnsupported, [](auto& c) { c.operation(static_cast<idl::Operation>(7)); }},
      {Cause::kUnsupported, [](auto& c) { c.target_kind(static_cast<idl::TargetKind>(7)); }},
      {Cause::kUnknownChannel, [](auto& c) { c.target() = ""; }},
      {Cause::kWrongType, [](auto& c) { c.values().clear(); }},
      {Cause::kWrongType, [](auto& c) { make_unknown(c.values()[0]); }},
      {Cause::kRange, [](auto& c) { c.values().resize(kMaxCommandValues + 1); }},
      {Cause::kWrongType,
       [&](auto& c) { to_address(c), c.encoding().type(static_cast<idl::ValueType>(70)); }},
      {Cause::kRange, [&](auto& c) { to_address(c), c.encoding().bit(64); }},
      {Cause::kRange, [&](auto& c) { to_address(c), c.encoding().bit(-2); }},
      {Cause::kWrongType,
       [&](auto& c) {
         to_address(c), c.encoding().bit(3), c.encoding().type(idl::ValueType::TYPE_INT16);
       }},
      {Cause::kRange,
       [&](auto& c) {
         to_address(c), c.encoding().scale(std::numeric_limits<double>::quiet_NaN());
       }},
      {Cause::kRange,
       [&](auto& c) {
         to_address(c), c.encoding().type(idl::ValueType::TYPE_STRING),
             c.encoding().string_bytes(0);
       }},
      {Cause::kRange,
       [&](auto& c) {
         to_address(c), c.encoding().type(idl::ValueType::TYPE_STRING),
             c.encoding().string_bytes(251);
       }},
      {Cause::kRange,
       [&](auto& c) { to_address(c), c.operation(idl::Operation::OPERATION_ACQUIRE), c.count(0); }},
      {Cause::kRange,
       [&](auto& c) {
         to_address(c), c.operation(idl::Operation::OPERATION_ACQUIRE), c.count(2049);
       }},
  };
  int number = 0;
  for (const Case& one : cases) {
    idl::Command topic;
    ASSERT_TRUE(to_idl("b", some_command(), topic));
    ASSERT_TRUE(from_idl(topic));
    one.damage(topic);
    const auto back = from_idl(topic);
    ASSERT_FALSE(back) << "case " << number;
    EXPECT_EQ(back.error().cause, one.cause) << "case " << number;
    EXPECT_FALSE(back.error().reason.empty());
    ++number;
  }
}

TEST(ResultConversion, ComesBackWithItsTimes) {
  CommandResult result{.requester = "r",
                       .request_id = 3,
                       .state = CommandState::kRejected,
                       .cause = Cause::kReadOnly,
                       .device_code = 4,
                       .reason = "read-only",
                       .values = {std::int64_t{1}, std::string("x")},
                       .received = at(100s),
                       .started = at(101s),
                       .completed = at(102s)};
  idl::CommandResult topic;
  to_idl("b", result, kMapping, topic);
  const StationResult back = from_idl(topic);
  EXPECT_EQ(back.requester, "r");
  EXPECT_EQ(back.request_id, 3u);
  EXPECT_EQ(back.bus, "b");
  EXPECT_EQ(back.state, CommandState::kRejected);
  EXPECT_EQ(back.cause, to_name(Cause::kReadOnly));
  EXPECT_EQ(back.device_code, 4);
  EXPECT_EQ(back.reason, "read-only");
  EXPECT_EQ(back.values, result.values);
  EXPECT_EQ(back.completed_at.nanoseconds - back.received_at.nanoseconds, 2'000'000'000);
}

TEST(ResultConversion, ValuesBeyondTheBoundAreLeftOutAndTheReasonSaysSo) {
  CommandResult result;
  result.values.assign(kMaxCommandValues + 5, Value{true});
  idl::CommandResult topic;
  to_idl("b", result, kMapping, topic);
  const StationResult back = from_idl(topic);
  EXPECT_EQ(back.values.size(), kMaxCommandValues);
  EXPECT_NE(back.reason.find("2048"), std::string::npos) << back.reason;
}

TEST(InterestConversion, WithoutNamesOrRefreshItIsNone) {
  idl::Interest topic;
  topic.station() = "s";
  topic.pattern() = "b/*/*";
  topic.refresh(Duration(200ms).count());
  const auto interest = from_idl(topic);
  ASSERT_TRUE(interest);
  EXPECT_EQ(interest->refresh, 200ms);
  topic.refresh(0);
  EXPECT_FALSE(from_idl(topic));
  topic.refresh(-1);
  EXPECT_FALSE(from_idl(topic));
  topic.refresh(1);
  topic.station() = "";
  EXPECT_FALSE(from_idl(topic));
}

TEST(StatusConversion, BusComesBackWithItsCauses) {
  BusReport report;
  report.state = BusState::kLeased;
  report.utilisation = 0.5;
  report.planned_load = 0.4;
  report.measured_load = 0.3;
  report.stretch = 1.5;
  report.exchanges = 1, report.samples = 2, report.commands = 3, report.deadline_misses = 4;
  report.bytes_sent = 5, report.bytes_received = 6, report.reopened = 7;
  report.causes.add(Cause::kChecksum);
  report.causes.add(Cause::kChecksum);
  report.causes.add(Cause::kNoResponse);
  report.misses.add(Cause::kLate);
  idl::BusStatus topic;
  to_idl("line-7", "b", report, {77}, topic);
  topic.dds_deadline_misses(8);
  const StationBusStatus back = from_idl(topic);
  EXPECT_EQ(back.bridge, "line-7");
  EXPECT_EQ(back.bus, "b");
  EXPECT_EQ(back.report.state, BusState::kLeased);
  EXPECT_EQ(back.report.utilisation, 0.5);
  EXPECT_EQ(back.report.planned_load, 0.4);
  EXPECT_EQ(back.report.measured_load, 0.3);
  EXPECT_EQ(back.report.stretch, 1.5);
  EXPECT_EQ(back.report.exchanges, 1u);
  EXPECT_EQ(back.report.samples, 2u);
  EXPECT_EQ(back.report.commands, 3u);
  EXPECT_EQ(back.report.deadline_misses, 4u);
  EXPECT_EQ(back.report.bytes_sent, 5u);
  EXPECT_EQ(back.report.bytes_received, 6u);
  EXPECT_EQ(back.report.reopened, 7u);
  EXPECT_EQ(back.causes, (CauseCounts{{std::string(to_name(Cause::kChecksum)), 2},
                                      {std::string(to_name(Cause::kNoResponse)), 1}}));
  EXPECT_EQ(back.misses, (CauseCounts{{std::string(to_name(Cause::kLate)), 1}}));
  EXPECT_EQ(back.dds_deadline_misses, 8u);
  EXPECT_EQ(back.reported_at.nanoseconds, 77);
}

TEST(StatusConversion, AClosedBusSaysWhyByItsFirstCause) {
  BusReport report;
  report.state = BusState::kClosed;
  report.closed_because = Cause::kPortMissing;
  report.causes.add(Cause::kChecksum);
  report.causes.add(Cause::kPortMissing);
  idl::BusStatus topic;
  to_idl("line-7", "b", report, {77}, topic);
  EXPECT_EQ(topic.causes().front().cause(), std::string(to_name(Cause::kPortMissing)));
  const StationBusStatus back = from_idl(topic);
  EXPECT_EQ(back.report.closed_because, Cause::kPortMissing);
  EXPECT_EQ(back.causes.size(), 2u);
}

TEST(StatusConversion, DeviceComesBackWithAtMost64Refusals) {
  DeviceReport report;
  report.state = DeviceState::kDegraded;
  report.exchanges = 1, report.failures = 2, report.retries = 3, report.deadline_misses = 4;
  report.response_time = 5ms, report.response_spread = 6ms, report.timeout = 7ms;
  report.pause = 8ms;
  report.areas.assign(40, {"holding", 9ms, 10ms, 125, 64});
  report.refused.assign(70, "holding:107");
  report.refused_gaps.assign(70, "holding:109..120");
  idl::DeviceStatus topic;
  to_idl("b", "d", report, {78}, topic);
  const StationDeviceStatus back = from_idl(topic);
  EXPECT_EQ(back.bus + "/" + back.device, "b/d");
  EXPECT_EQ(back.report.state, DeviceState::kDegraded);
  EXPECT_EQ(back.report.exchanges, 1u);
  EXPECT_EQ(back.report.failures, 2u);
  EXPECT_EQ(back.report.retries, 3u);
  EXPECT_EQ(back.report.deadline_misses, 4u);
  EXPECT_EQ(back.report.response_time, 5ms);
  EXPECT_EQ(back.report.response_spread, 6ms);
  EXPECT_EQ(back.report.timeout, 7ms);
  EXPECT_EQ(back.report.pause, 8ms);
  EXPECT_EQ(back.report.areas, std::vector<AreaReport>(32, {"holding", 9ms, 10ms, 125, 64}));
  EXPECT_EQ(back.report.refused_gaps, std::vector<std::string>(64, "holding:109..120"));
  EXPECT_EQ(back.report.refused, std::vector<std::string>(64, "holding:107"));
}

TEST(StatusConversion, AnAuditEntryComesBackCutAtItsBounds) {
  const AuditReport report{"bridge",
                           7,
                           3,
                           {9},
                           "plant/anna",
                           "write 21.5",
                           "line/press/speed",
                           8,
                           10,
                           std::string(300, 'x')};
  idl::Audit topic;
  to_idl(report, topic);
  const AuditReport back = from_idl(topic);
  EXPECT_EQ(back.bridge, "bridge");
  EXPECT_EQ(back.epoch, 7u);
  EXPECT_EQ(back.number, 3u);
  EXPECT_EQ(back.at.nanoseconds, 9);
  EXPECT_EQ(back.who, "plant/anna");
  EXPECT_EQ(back.what, "write 21.5");
  EXPECT_EQ(back.target, "line/press/speed");
  EXPECT_EQ(back.bytes_to_device, 8u);
  EXPECT_EQ(back.bytes_from_device, 10u);
  EXPECT_EQ(back.result.size(), 256u);
}

TEST(StatusConversion, AProgramRequestComesBackCutAtItsBound) {
  idl::ProgramRequest topic;
  to_idl({"b", "d", std::string(200, 'x'), {3}}, topic);
  const ProgramRequestReport back = from_idl(topic);
  EXPECT_EQ(back.bus + "/" + back.device, "b/d");
  EXPECT_EQ(back.request, std::string(128, 'x'));
  EXPECT_EQ(back.sent_at.nanoseconds, 3);
}

TEST(StatusConversion, ADeviceIsDescribedWithTheDigitsThatAreKnown) {
  BusSpec bus;
  bus.name = "b";
  DeviceSpec device;
  device.name = "d";
  device.protocol = "modbus-rtu";
  device.link.address = 7;
  device.channels.resize(3);
  device.channels[0].name = "force";
  device.channels[0].digits = 0;
  device.channels[1].name = "temperature";
  device.channels[1].encoding.scale = 0.1;
  device.channels[2].name = "count";
  idl::DeviceDescription topic;
  to_idl("line-7", bus, device, topic);
  StationDeviceDescription back = from_idl(topic);
  EXPECT_EQ(back, (StationDeviceDescription{
                      .bridge = "line-7",
                      .bus = "b",
                      .device = "d",
                      .protocol = "modbus-rtu",
                      .port = to_text(bus.port),
                      .address = "7",
                      .digits = {{"force", {0, true}}, {"temperature", {1, false}}}}));
  topic.digits()[0].digits(10);  // from the network
  EXPECT_FALSE(from_idl(topic).digits.contains("force"));

  device.link.long_address = "01234567";
  device.channels.own().assign(kMaxDescribedChannels + 1, device.channels[0]);
  to_idl("line-7", bus, device, topic);
  EXPECT_EQ(from_idl(topic).address, "01234567");
  EXPECT_EQ(topic.digits().size(), kMaxDescribedChannels);
}

TEST(StatusConversion, AProgramSessionComesBack) {
  idl::ProgramSession topic;
  to_idl({"b", "d", ProgramSessionState::kOpen, "anna (10.0.0.7:5)", 1, 2, {3}}, topic);
  const ProgramSessionReport back = from_idl(topic);
  EXPECT_EQ(back.bus + "/" + back.device, "b/d");
  EXPECT_EQ(back.state, ProgramSessionState::kOpen);
  EXPECT_EQ(back.who, "anna (10.0.0.7:5)");
  EXPECT_EQ(back.bytes_to_device, 1u);
  EXPECT_EQ(back.bytes_from_device, 2u);
  EXPECT_EQ(back.since.nanoseconds, 3);
  topic.state(static_cast<idl::SessionState>(77));
  EXPECT_EQ(from_idl(topic).state, ProgramSessionState::kClosed);
}

}  // namespace
}  // namespace fieldcast
