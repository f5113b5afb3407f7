#include "tools/forward/outlet/sparkplug/edge_node.hpp"

#include <gmock/gmock.h>

#include "schema/sparkplug.pb.h"
#include "tests/tools/forward/batch_support.hpp"
#include "tools/forward/outlet/sparkplug/primary_host.hpp"
#include "tools/forward/payload/codec.hpp"

namespace fieldcast::forward {
namespace {

using sparkplug::SparkplugMetric;
using sparkplug::SparkplugPayload;
using testing::ElementsAre;

constexpr UtcTime kEdgeNow{1'764'360'000'123'000'000};

SparkplugPayload payload_of(const MqttMessage& message) {
  SparkplugPayload payload;
  EXPECT_TRUE(payload.ParseFromString(message.payload));
  return payload;
}

std::vector<std::string> edge_topics_of(const std::vector<MqttMessage>& messages) {
  std::vector<std::string> topics;
  for (const MqttMessage& message : messages) topics.push_back(message.topic);
  return topics;
}

std::optional<std::uint32_t> sent_quality_of(const SparkplugMetric& metric) {
  for (int i = 0; i < metric.properties().keys_size(); ++i) {
    if (metric.properties().keys(i) == "Quality") return metric.properties().values(i).int_value();
  }
  return std::nullopt;
}

struct EdgeNodeTest : testing::Test {
  SparkplugSpec spec;
  DeviceCatalogue present = catalogue({"temperature", "level"});
  EdgeNode node{spec, "north", [this](std::uint64_t) { return encode("north", present); }};
  std::uint64_t next_record = 1;

  std::vector<MqttMessage> send(SampleBatch batch, bool is_late = false) {
    batch.catalogue = identity_of(present);
    Record record = record_of(batch);
    record.id = next_record++;
    record.is_late = is_late;
    return node.messages(record, kEdgeNow).value();
  }
  static SampleBatch one(std::int64_t second, Value value, Quality quality = Quality::kGood,
                         std::uint32_t channel = 0) {
    return {"line",
            "press",
            7,
            0,
            {{.channel = channel,
              .sequence = static_cast<std::uint64_t>(second),
              .acquired_at = {second * 1'000'000'000},
              .value = std::move(value),
              .quality = quality}}};
  }
};

TEST_F(EdgeNodeTest, TheWillHasTheNumberOfTheBirthThatFollows) {
  for (const auto& [connection, number] : {std::pair{0u, 0u}, {1u, 1u}, {255u, 255u}, {256u, 0u}}) {
    const MqttMessage will = node.will(connection, kEdgeNow);
    EXPECT_EQ(will.topic, "spBv1.0/fieldcast/NDEATH/north");
    EXPECT_EQ(will.qos, 1);
    const SparkplugPayload death = payload_of(will);
    EXPECT_FALSE(death.has_seq());
    ASSERT_EQ(death.metrics_size(), 1);
    EXPECT_EQ(death.metrics(0).name(), "bdSeq");
    EXPECT_EQ(death.metrics(0).long_value(), number);
    const auto births = node.births(kEdgeNow);
    EXPECT_THAT(edge_topics_of(births), ElementsAre("spBv1.0/fieldcast/NBIRTH/north"));
    EXPECT_EQ(births[0].qos, 0);
    const SparkplugPayload birth = payload_of(births[0]);
    EXPECT_EQ(birth.seq(), 0u);
    EXPECT_EQ(birth.metrics(0).long_value(), number);
    EXPECT_EQ(birth.metrics(1).name(), "Node Control/Rebirth");
    EXPECT_FALSE(birth.metrics(1).boolean_value());
  }
}

TEST_F(EdgeNodeTest, ADeviceIsBornBeforeItsFirstData) {
  (void)node.births(kEdgeNow);
  const auto messages = send(one(5, 20.5));
  EXPECT_THAT(edge_topics_of(messages), ElementsAre("spBv1.0/fieldcast/DBIRTH/north/line:press",
                                                    "spBv1.0/fieldcast/DDATA/north/line:press"));
  const SparkplugPayload birth = payload_of(messages[0]);
  EXPECT_EQ(birth.seq(), 1u);
  ASSERT_EQ(birth.metrics_size(), 2);
  const SparkplugMetric& metric = birth.metrics(0);
  EXPECT_EQ(metric.name(), "temperature");
  EXPECT_EQ(metric.datatype(), 9u);
  EXPECT_TRUE(metric.is_null()) << "no value is known yet";
  EXPECT_EQ(sent_quality_of(metric), 500u);
  EXPECT_EQ(metric.properties().keys(1), "engUnit");
  EXPECT_EQ(metric.properties().values(1).string_value(), "°C");
  EXPECT_NE(metric.alias(), birth.metrics(1).alias());
  const SparkplugPayload data = payload_of(messages[1]);
  EXPECT_EQ(data.seq(), 2u);
  EXPECT_EQ(data.timestamp(), 1'764'360'000'123u);
  ASSERT_EQ(data.metrics_size(), 1);
  EXPECT_EQ(data.metrics(0).alias(), metric.alias());
  EXPECT_FALSE(data.metrics(0).has_name());
  EXPECT_FALSE(data.metrics(0).has_datatype());
  EXPECT_EQ(data.metrics(0).timestamp(), 5'000u);
  EXPECT_EQ(data.metrics(0).float_value(), 20.5f);
  EXPECT_THAT(edge_topics_of(send(one(6, 21.0))),
              ElementsAre("spBv1.0/fieldcast/DDATA/north/line:press"));
}

TEST_F(EdgeNodeTest, ARebirthRepeatsTheLastValuesAndAliases) {
  (void)node.births(kEdgeNow);
  const auto alias = payload_of(send(one(5, 20.5))[0]).metrics(0).alias();
  const auto births = node.births(kEdgeNow);
  ASSERT_EQ(births.size(), 2u);
  EXPECT_EQ(payload_of(births[0]).seq(), 0u);
  const SparkplugPayload birth = payload_of(births[1]);
  EXPECT_EQ(birth.seq(), 1u);
  EXPECT_EQ(birth.metrics(0).alias(), alias);
  EXPECT_EQ(birth.metrics(0).float_value(), 20.5f);
  EXPECT_EQ(birth.metrics(0).timestamp(), 5'000u);
  EXPECT_EQ(sent_quality_of(birth.metrics(0)), 192u);
}

TEST_F(EdgeNodeTest, TheSequenceOfMessagesBeginsAgainAfter255) {
  (void)node.births(kEdgeNow);
  (void)send(one(1, 1.0));
  std::uint64_t last = 2;
  for (int i = 0; i < 300; ++i) {
    const std::uint64_t seq = payload_of(send(one(2 + i, 1.0))[0]).seq();
    EXPECT_EQ(seq, (last + 1) % 256);
    last = seq;
  }
}

TEST_F(EdgeNodeTest, ABadValueIsNullAndTheNextGoodOneHasItsQuality) {
  (void)node.births(kEdgeNow);
  (void)send(one(1, 1.0));
  EXPECT_FALSE(sent_quality_of(payload_of(send(one(2, 1.0))[0]).metrics(0)));
  const auto bad = payload_of(send(one(3, 1.0, Quality::kBadDeviceError))[0]).metrics(0);
  EXPECT_TRUE(bad.is_null());
  EXPECT_EQ(bad.value_case(), SparkplugMetric::VALUE_NOT_SET);
  EXPECT_EQ(sent_quality_of(bad), 0u);
  EXPECT_EQ(sent_quality_of(payload_of(send(one(4, 2.0))[0]).metrics(0)), 192u);
  const auto old = payload_of(send(one(5, 2.0, Quality::kUncertain))[0]).metrics(0);
  EXPECT_EQ(old.float_value(), 2.0f);
  EXPECT_EQ(sent_quality_of(old), 500u);
}

TEST_F(EdgeNodeTest, LateSamplesAreHistoricalAndNotTheLastValue) {
  (void)node.births(kEdgeNow);
  (void)send(one(9, 9.0));
  const auto late = payload_of(send(one(2, 2.0), true)[0]).metrics(0);
  EXPECT_TRUE(late.is_historical());
  EXPECT_EQ(late.timestamp(), 2'000u);
  EXPECT_EQ(payload_of(node.births(kEdgeNow)[1]).metrics(0).float_value(), 9.0f);
}

TEST_F(EdgeNodeTest, AScaledIntegerBecomesADouble) {
  present.channels[0].type = "int16";
  (void)node.births(kEdgeNow);
  EXPECT_EQ(payload_of(send(one(1, std::int64_t{-3}))[0]).metrics(0).datatype(), 2u);
  const auto messages = send(one(2, 2.5));
  ASSERT_EQ(messages.size(), 2u) << "a birth with the new type";
  EXPECT_EQ(payload_of(messages[0]).metrics(0).datatype(), 10u);
  EXPECT_EQ(payload_of(messages[1]).metrics(0).double_value(), 2.5);
}

TEST_F(EdgeNodeTest, MetricsAreInTheOrderOfTime) {
  (void)node.births(kEdgeNow);
  SampleBatch batch = one(5, 5.0);
  batch.samples.push_back(one(7, 7.0).samples[0]);
  batch.samples.push_back(one(6, 6.0, Quality::kGood, 1).samples[0]);
  const SparkplugPayload data = payload_of(send(batch)[1]);
  EXPECT_EQ(data.metrics(0).timestamp(), 5'000u);
  EXPECT_EQ(data.metrics(1).timestamp(), 6'000u);
  EXPECT_EQ(data.metrics(2).timestamp(), 7'000u);
}

TEST_F(EdgeNodeTest, ASilentDeviceDiesAndIsBornAgain) {
  (void)node.births(kEdgeNow);
  (void)send(one(1, 1.0));
  (void)send(one(1, 1.0, Quality::kGood, 1));
  (void)send(one(2, 1.0, Quality::kBadNoResponse));
  EXPECT_THAT(edge_topics_of(send(one(2, 1.0, Quality::kBadNoResponse, 1))),
              ElementsAre("spBv1.0/fieldcast/DDATA/north/line:press",
                          "spBv1.0/fieldcast/DDEATH/north/line:press"));
  EXPECT_TRUE(send(one(3, 1.0, Quality::kBadNoResponse)).empty());
  EXPECT_EQ(node.births(kEdgeNow).size(), 1u) << "without the dead device";
  EXPECT_THAT(edge_topics_of(send(one(4, 4.0))),
              ElementsAre("spBv1.0/fieldcast/DBIRTH/north/line:press",
                          "spBv1.0/fieldcast/DDATA/north/line:press"));
}

// Regression: a channel that is not read, or has no valid address, kept a silent device alive.
TEST_F(EdgeNodeTest, ASilentDeviceDiesWhateverChannelsItHas) {
  present = catalogue({"temperature", "level", "button", "wrong"});
  present.channels[2].refresh = {};
  (void)node.births(kEdgeNow);
  (void)send(one(1, 1.0));
  (void)send(one(1, 1.0, Quality::kBadConfiguration, 3));
  EXPECT_THAT(edge_topics_of(send(one(2, 1.0, Quality::kBadNoResponse))),
              ElementsAre("spBv1.0/fieldcast/DDATA/north/line:press"))
      << "the level is not known";
  (void)send(one(2, 1.0, Quality::kBadDeviceError, 1));
  EXPECT_THAT(edge_topics_of(send(one(3, 1.0, Quality::kBadNoResponse))),
              ElementsAre("spBv1.0/fieldcast/DDATA/north/line:press"))
      << "the device refuses the level";
  EXPECT_THAT(edge_topics_of(send(one(4, 1.0, Quality::kBadNoResponse, 1))),
              ElementsAre("spBv1.0/fieldcast/DDATA/north/line:press",
                          "spBv1.0/fieldcast/DDEATH/north/line:press"));
  EXPECT_TRUE(send(one(5, 1.0, Quality::kUncertain)).empty());
  EXPECT_EQ(send(one(6, 1.0, Quality::kBadDeviceError)).size(), 2u) << "it responds again";
}

// Regression: hosts showed the last values of a killed bridge as good.
TEST_F(EdgeNodeTest, ADeviceWithoutABridgeDiesAndIsBornAgain) {
  bool is_announced = true;
  const auto deaths = [&] {
    return node.deaths(
        [&](const std::string& bus, const std::string& device) {
          EXPECT_EQ(bus + ' ' + device, "line press");
          return is_announced;
        },
        kEdgeNow);
  };
  (void)node.births(kEdgeNow);
  EXPECT_TRUE(deaths().empty()) << "no device is born yet";
  (void)send(one(1, 1.0, Quality::kGood, 1));
  EXPECT_TRUE(deaths().empty());
  is_announced = false;
  const auto messages = deaths();
  EXPECT_THAT(edge_topics_of(messages), ElementsAre("spBv1.0/fieldcast/DDEATH/north/line:press"));
  EXPECT_EQ(payload_of(messages[0]).seq(), 3u);
  EXPECT_TRUE(deaths().empty());
  EXPECT_EQ(node.births(kEdgeNow).size(), 1u);
  EXPECT_TRUE(send(one(2, 1.0, Quality::kNotYetRead)).empty());
  const auto again = send(one(3, 1.0));
  ASSERT_EQ(again.size(), 2u);
  EXPECT_EQ(sent_quality_of(payload_of(again[0]).metrics(1)), 500u) << "of before";
}

TEST_F(EdgeNodeTest, AChangedCatalogueIsANewBirthAndAnOldOneIsNot) {
  (void)node.births(kEdgeNow);
  const DeviceCatalogue old = present;
  const auto alias = payload_of(send(one(1, 1.0))[0]).metrics(0).alias();
  const auto catalogue_record = [this](const DeviceCatalogue& content, std::uint64_t id) {
    Record record{.id = id,
                  .kind = RecordKind::kCatalogue,
                  .bus = "line",
                  .device = "press",
                  .identity = identity_of(content),
                  .body = encode("north", content)};
    return node.messages(record, kEdgeNow).value().size();
  };
  present = catalogue({"flow", "temperature"});
  EXPECT_EQ(catalogue_record(present, 50), 0u) << "born with the next samples";
  EXPECT_EQ(catalogue_record(old, 40), 0u);
  next_record = 51;
  const auto messages = send(one(2, 2.0));
  ASSERT_EQ(messages.size(), 2u);
  const SparkplugPayload birth = payload_of(messages[0]);
  EXPECT_EQ(birth.metrics(0).name(), "flow");
  EXPECT_EQ(birth.metrics(1).alias(), alias) << "an alias belongs to its channel permanently";
  EXPECT_EQ(birth.metrics(1).float_value(), 1.0f);
}

TEST_F(EdgeNodeTest, AnAlarmIsAMetricOfItsDevice) {
  present.channels[1].limits.high_high = 80.0;
  (void)node.births(kEdgeNow);
  const SparkplugPayload birth = payload_of(send(one(1, 1.0))[0]);
  ASSERT_EQ(birth.metrics_size(), 3);
  EXPECT_EQ(birth.metrics(2).name(), "Alarms/level/high-high");
  EXPECT_TRUE(birth.metrics(2).is_null());
  StationAlarmStatus raised = alarm();
  raised.status.active = true;
  const Record record{.id = 90,
                      .kind = RecordKind::kAlarm,
                      .bus = "line",
                      .device = "press",
                      .body = encode("north", raised)};
  const auto messages = node.messages(record, kEdgeNow).value();
  ASSERT_EQ(messages.size(), 1u);
  EXPECT_EQ(payload_of(messages[0]).metrics(0).alias(), birth.metrics(2).alias());
  EXPECT_TRUE(payload_of(messages[0]).metrics(0).boolean_value());
  EXPECT_TRUE(payload_of(node.births(kEdgeNow)[1]).metrics(2).boolean_value());
}

TEST_F(EdgeNodeTest, AnAlarmBeforeTheCatalogueIsInTheBirth) {
  present.channels[1].limits.high_high = 80.0;
  (void)node.births(kEdgeNow);
  const Record record{.id = 1,
                      .kind = RecordKind::kAlarm,
                      .bus = "line",
                      .device = "press",
                      .body = encode("north", alarm())};
  EXPECT_TRUE(node.messages(record, kEdgeNow).value().empty());
  EXPECT_TRUE(payload_of(send(one(1, 1.0))[0]).metrics(2).boolean_value());
}

TEST_F(EdgeNodeTest, NamesInTopicsAreEscaped) {
  spec.group = "a/b";
  spec.edge_node = "n+1";
  EXPECT_EQ(EdgeNode(spec, "north", {}).command_topic(), "spBv1.0/a=2Fb/NCMD/n=2B1");
}

struct DeviceCommandTest : EdgeNodeTest {
  void SetUp() override {
    spec.command_user = "scada";
    present.channels[0].access = Access::kReadWrite;
    present.channels[1].type = "int16";
    present.channels[1].access = Access::kWriteOnly;
    host.emplace(spec, "north", [this](std::uint64_t) { return encode("north", present); });
    SampleBatch batch = one(5, 20.5);
    batch.catalogue = identity_of(present);
    const auto messages = host->messages(record_of(batch), kEdgeNow);
    const SparkplugPayload birth = payload_of(messages->at(0));
    alias = birth.metrics(0).alias();
    for (int i = 0; i < birth.metrics(0).properties().keys_size(); ++i) {
      if (birth.metrics(0).properties().keys(i) != "readOnly") continue;
      EXPECT_FALSE(birth.metrics(0).properties().values(i).boolean_value());
    }
    payload.set_timestamp(kEdgeNow.nanoseconds / 1'000'000 + 1);
  }
  std::vector<EdgeNode::Write> writes(const std::string& device = "line:press") const {
    return host->writes(
        {"spBv1.0/fieldcast/DCMD/north/" + device, payload.SerializeAsString(), 0, false});
  }
  std::string fault(const std::string& device = "line:press") const {
    const auto found = writes(device);
    return found.size() == 1 && !found[0] ? found[0].error() : "accepted";
  }

  std::optional<EdgeNode> host;
  SparkplugPayload payload;
  std::uint64_t alias = 0;
};

TEST_F(DeviceCommandTest, IsAWriteOfItsUser) {
  payload.add_metrics()->set_alias(alias);
  payload.mutable_metrics(0)->set_float_value(21.5f);
  payload.add_metrics()->set_name("level");
  payload.mutable_metrics(1)->set_int_value(static_cast<std::uint32_t>(-3));
  const auto found = writes();
  ASSERT_EQ(found.size(), 2u);
  ASSERT_TRUE(found[0]) << found[0].error();
  EXPECT_EQ(found[0]->user, "scada");
  EXPECT_EQ(found[0]->channel.text(), "line/press/temperature");
  EXPECT_EQ(found[0]->value, Value{21.5});
  EXPECT_TRUE(found[0]->verify);
  EXPECT_EQ(found[0]->expires_at.nanoseconds,
            kEdgeNow.nanoseconds + 1'000'000 + EdgeNode::kCommandLife.count());
  EXPECT_EQ(found[1]->value, Value{std::int64_t{-3}});
  EXPECT_FALSE(found[1]->verify) << "it cannot be read";
  EXPECT_NE(found[0]->id, found[1]->id);
  EXPECT_EQ(writes()[0]->id, found[0]->id) << "a repeated message";
  EXPECT_TRUE(
      command_request_from(to_json(*found[0]), "scada", {{"scada", {Pattern()}}}, kEdgeNow));
  payload.set_timestamp(payload.timestamp() + 1);
  EXPECT_NE(writes()[0]->id, found[0]->id);
}

TEST_F(DeviceCommandTest, WithoutDeviceChannelTimeOrValueIsRefused) {
  payload.add_metrics()->set_name("temperature");
  EXPECT_EQ(fault(), "temperature: the value is null or not of the type of the metric");
  payload.mutable_metrics(0)->set_string_value("21");
  EXPECT_EQ(fault(), "temperature: the value is null or not of the type of the metric");
  payload.mutable_metrics(0)->set_float_value(21);
  EXPECT_EQ(fault(), "accepted");
  EXPECT_EQ(fault("line:mill"), "no such device is born");
  payload.set_timestamp(payload.timestamp() - 2);
  EXPECT_THAT(fault(), testing::HasSubstr("older than the birth"));
  payload.clear_timestamp();
  EXPECT_EQ(fault(), "the payload has no timestamp");
  payload.set_timestamp(kEdgeNow.nanoseconds / 1'000'000 + 1);
  payload.mutable_metrics(0)->set_name("void");
  EXPECT_EQ(fault(), "void: the device has no such channel");
  payload.mutable_metrics(0)->clear_name();
  payload.mutable_metrics(0)->set_alias(99);
  EXPECT_EQ(fault(), "alias 99: the device has no such channel");
  const auto poison = host->writes({"spBv1.0/fieldcast/DCMD/north/line:press", "\xFF", 0, false});
  EXPECT_EQ(poison.at(0).error(), "the payload cannot be decoded");
}

TEST(CommandMetric, AnIntegerHasTheSignOfTheType) {
  CommandMetric metric{.raw = Value{std::uint64_t{0xFFFFFFFE}}};
  EXPECT_EQ(value_of(metric, MetricType::kInt8), Value{std::int64_t{-2}});
  EXPECT_EQ(value_of(metric, MetricType::kInt64), Value{std::int64_t{-2}});
  EXPECT_EQ(value_of(metric, MetricType::kUInt64), Value{std::uint64_t{0xFFFFFFFE}});
  EXPECT_FALSE(value_of(metric, MetricType::kUInt16));
  EXPECT_FALSE(value_of(metric, MetricType::kBoolean));
  metric = {.raw = Value{std::uint64_t{0xFFFFFFFF'FFFFFFFD}}, .is_long = true};
  EXPECT_EQ(value_of(metric, MetricType::kInt64), Value{std::int64_t{-3}});
  EXPECT_EQ(value_of({.raw = Value{0.1}}, MetricType::kFloat), Value{0.1});
  EXPECT_FALSE(value_of({}, MetricType::kDouble));
}

TEST(NodeCommand, OnlyARebirthIsAccepted) {
  SparkplugPayload payload;
  auto& rebirth = *payload.add_metrics();
  rebirth.set_name("Node Control/Rebirth");
  rebirth.set_boolean_value(true);
  EXPECT_TRUE(decode_command(payload.SerializeAsString())->rebirth);
  rebirth.set_boolean_value(false);
  payload.add_metrics()->set_alias(7);
  const auto command = decode_command(payload.SerializeAsString());
  EXPECT_FALSE(command->rebirth);
  ASSERT_EQ(command->metrics.size(), 1u);
  EXPECT_EQ(command->metrics[0].text(), "alias 7");
  for (int i = 0; i < 100; ++i) payload.add_metrics();
  EXPECT_EQ(decode_command(payload.SerializeAsString())->metrics.size(), kMostCommanded);
  EXPECT_FALSE(decode_command("\xFF"));
}

TEST(PrimaryHost, IsOnlineAfterANewerState) {
  PrimaryHost host;
  EXPECT_FALSE(host.is_online());
  EXPECT_TRUE(host.on_state(R"({"online":true,"timestamp":100})"));
  EXPECT_TRUE(host.is_online());
  EXPECT_TRUE(host.on_state(R"({"online":false,"timestamp":99})"));
  EXPECT_TRUE(host.is_online()) << "the will of an earlier session";
  EXPECT_TRUE(host.on_state(R"({"online":false,"timestamp":100})"));
  EXPECT_FALSE(host.is_online());
  for (const char* wrong : {"", "ONLINE", "[]", R"({"online":true})",
                            R"({"online":1,"timestamp":5})", R"({"online":true,"timestamp":"5"})"})
    EXPECT_FALSE(host.on_state(wrong)) << wrong;
}

TEST(MetricType, ValuesFitTheirTypes) {
  EXPECT_EQ(metric_type_of("string(16)"), MetricType::kString);
  EXPECT_EQ(metric_type_of("uint32"), MetricType::kUInt64);
  EXPECT_TRUE(fits(MetricType::kInt8, std::int64_t{-128}));
  EXPECT_FALSE(fits(MetricType::kInt8, std::int64_t{128}));
  EXPECT_TRUE(fits(MetricType::kUInt16, std::uint64_t{65'535}));
  EXPECT_FALSE(fits(MetricType::kInt64, std::uint64_t{1} << 63));
  EXPECT_TRUE(fits(MetricType::kFloat, 0.5));
  EXPECT_FALSE(fits(MetricType::kFloat, 0.1)) << "would lose digits";
  EXPECT_FALSE(fits(MetricType::kBoolean, std::int64_t{1}));
  EXPECT_EQ(widest_type_of(0.1), MetricType::kDouble);
}

}  // namespace
}  // namespace fieldcast::forward
