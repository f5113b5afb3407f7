#include "tools/forward/outlet/mqtt/mqtt_messages.hpp"

#include <gmock/gmock.h>

#include <nlohmann/json.hpp>

#include "tests/tools/forward/batch_support.hpp"
#include "tools/forward/outlet/mqtt/discovery.hpp"
#include "tools/forward/outlet/mqtt/topics.hpp"
#include "tools/forward/payload/codec.hpp"

namespace fieldcast::forward {
namespace {

using ParsedJson = nlohmann::json;
using testing::ElementsAre;

Record catalogue_record(const DeviceCatalogue& catalogue) {
  return {.kind = RecordKind::kCatalogue,
          .bus = catalogue.bus,
          .device = catalogue.device,
          .identity = identity_of(catalogue),
          .body = encode("north", catalogue)};
}

MqttMessages messages_with(const MqttSpec& spec) {
  return {spec, "north", [](std::uint64_t) {
            return encode("north", catalogue({"temperature", "a/b"}));
          }};
}

TEST(MqttTopics, CharactersWithAMeaningInTopicsAreEscaped) {
  EXPECT_EQ(topic_level("press-1_A.b"), "press-1_A.b");
  EXPECT_EQ(topic_level("a/b+c#"), "a=2Fb=2Bc=23");
  EXPECT_EQ(topic_level("a=2Fb"), "a=3D2Fb") << "two names never get one level";
  EXPECT_EQ(topic_level("ü\n"), "=C3=BC=0A");
  EXPECT_EQ(topic_level(""), "=");
}

TEST(MqttMessages, EachSampleIsAMessageOfItsChannel) {
  SampleBatch batch = seconds(0, 1);
  batch.samples.push_back({.channel = 1,
                           .sequence = 5,
                           .acquired_at = {7},
                           .value = std::int64_t{-3},
                           .quality = Quality::kBadDeviceError,
                           .device_code = 4});
  MqttMessages messages = messages_with({});
  const auto made = messages.of(record_of(batch));
  ASSERT_TRUE(made);
  ASSERT_EQ(made->size(), 2u);
  EXPECT_EQ((*made)[0].topic, "fieldcast/north/line/press/temperature");
  EXPECT_EQ((*made)[0].qos, 1);
  EXPECT_FALSE((*made)[0].retain);
  EXPECT_EQ(ParsedJson::parse((*made)[0].payload),
            ParsedJson::parse(R"({"value":1.0,"quality":"GOOD","acquired_at":0,
      "unit":"°C","epoch":"7","sequence":1})"));
  EXPECT_EQ((*made)[1].topic, "fieldcast/north/line/press/a=2Fb");
  EXPECT_EQ(ParsedJson::parse((*made)[1].payload)["device_code"], 4);
}

TEST(MqttMessages, OnlyPresentSamplesAreRetained) {
  MqttSpec spec;
  spec.retain = true;
  spec.prefix = "plant";
  MqttMessages messages = messages_with(spec);
  Record record = record_of(seconds(0, 1));
  EXPECT_TRUE(messages.of(record)->front().retain);
  record.is_late = true;
  const auto late = messages.of(record);
  EXPECT_FALSE(late->front().retain);
  EXPECT_EQ(late->front().topic, "plant-late/north/line/press/temperature");
}

TEST(MqttMessages, AlarmsAndTheStateOfTheSiteHaveTopicsOfTheirOwn) {
  MqttMessages messages = messages_with({});
  const Record record{.kind = RecordKind::kAlarm,
                      .bus = "line",
                      .device = "press",
                      .body = encode("north", alarm())};
  const auto made = messages.of(record);
  ASSERT_EQ(made->size(), 1u);
  EXPECT_EQ(made->front().topic, "fieldcast-alarm/north/line/press/level/high-high");
  EXPECT_EQ(ParsedJson::parse(made->front().payload)["channel"], "level");
  EXPECT_EQ(messages.status(true).topic, "fieldcast-status/north");
  EXPECT_EQ(messages.status(false).payload, "offline");
  EXPECT_TRUE(messages.status(false).retain);
}

TEST(MqttMessages, ADeviceIsOfflineWhileNoBridgeAnnouncesIt) {
  MqttMessages messages = messages_with({});
  bool is_announced = true;
  const auto status = [&](bool all = false) {
    std::vector<std::string> texts;
    for (const MqttMessage& message : messages.device_status(
             [&](const std::string&, const std::string&) { return is_announced; }, all)) {
      EXPECT_TRUE(message.retain);
      texts.push_back(message.topic + ' ' + message.payload);
    }
    return texts;
  };
  const std::string topic = "fieldcast-status/north/line/press ";
  EXPECT_THAT(status(true), ElementsAre()) << "no record yet";
  ASSERT_TRUE(messages.of(record_of(seconds(0, 1))));
  EXPECT_THAT(status(), ElementsAre(topic + "online"));
  EXPECT_THAT(status(), ElementsAre());
  is_announced = false;
  EXPECT_THAT(status(), ElementsAre(topic + "offline"));
  EXPECT_THAT(status(), ElementsAre());
  EXPECT_THAT(status(true), ElementsAre(topic + "offline")) << "after each connection";
}

TEST(MqttMessages, ARecordThatCannotBeDecodedHasNone) {
  MqttMessages messages = messages_with({});
  EXPECT_FALSE(messages.of({.body = "\xFF"}));
  EXPECT_FALSE(messages.of({.kind = RecordKind::kAlarm, .body = "\xFF"}));
  EXPECT_FALSE(messages.of({.kind = RecordKind::kCatalogue, .body = "\xFF"}));
}

std::vector<std::string> mqtt_topics_of(const std::vector<MqttMessage>& messages) {
  std::vector<std::string> topics;
  for (const MqttMessage& message : messages) topics.push_back(message.topic);
  return topics;
}

TEST(Discovery, DescribesEachChannelAndRemovesThoseThatAreGone) {
  MqttSpec spec;
  spec.discovery = true;
  MqttMessages messages = messages_with(spec);
  DeviceCatalogue first = catalogue({"temperature", "running"});
  first.channels[1].type = "bool";
  first.channels[1].unit = "";
  const auto made = messages.of(catalogue_record(first));
  EXPECT_THAT(mqtt_topics_of(*made),
              ElementsAre("fieldcast-catalogue/north/line/press",
                          "homeassistant/sensor/fieldcast_north_line_press_temperature/config",
                          "homeassistant/binary_sensor/fieldcast_north_line_press_running/config"));
  const ParsedJson sensor = ParsedJson::parse((*made)[1].payload);
  EXPECT_EQ(sensor["state_topic"], "fieldcast/north/line/press/temperature");
  EXPECT_EQ(sensor["unit_of_measurement"], "°C");
  EXPECT_EQ(sensor["device_class"], "temperature");
  EXPECT_EQ(sensor["availability"][0]["topic"], "fieldcast-status/north");
  EXPECT_EQ(sensor["availability"][1]["topic"], "fieldcast-status/north/line/press");
  EXPECT_TRUE((*made)[1].retain);
  const ParsedJson binary = ParsedJson::parse((*made)[2].payload);
  EXPECT_FALSE(binary.contains("device_class"));
  EXPECT_EQ(binary["value_template"], "{{ 'ON' if value_json.value else 'OFF' }}");
  const auto later = messages.of(catalogue_record(catalogue({"temperature"})));
  ASSERT_EQ(later->size(), 3u);
  EXPECT_EQ((*later)[2].topic,
            "homeassistant/binary_sensor/fieldcast_north_line_press_running/config");
  EXPECT_TRUE((*later)[2].payload.empty());
}

TEST(Discovery, OnlyAUnitOfOneDeviceClassNamesIt) {
  EXPECT_EQ(device_class_of("kWh"), "energy");
  EXPECT_EQ(device_class_of("%"), "") << "humidity, battery, power factor ..";
  EXPECT_EQ(device_class_of(""), "");
}

}  // namespace
}  // namespace fieldcast::forward
