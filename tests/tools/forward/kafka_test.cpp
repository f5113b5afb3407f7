#include <gmock/gmock.h>

#include <array>
#include <cstdio>
#include <filesystem>

#include "tests/tools/forward/batch_support.hpp"
#include "tools/forward/outlet/kafka/kafka_messages.hpp"
#include "tools/forward/outlet/kafka/kafka_options.hpp"

namespace fieldcast::forward {
namespace {

using testing::HasSubstr;

std::string value_of(const KafkaConf& conf, const char* name) {
  std::array<char, 512> text{};
  std::size_t size = text.size();
  return rd_kafka_conf_get(conf.get(), name, text.data(), &size) == RD_KAFKA_CONF_OK ? text.data()
                                                                                     : "?";
}

TEST(KafkaMessages, EachKindHasItsTopic) {
  const KafkaTopics topics;
  Record record = record_of(seconds(0, 3));
  EXPECT_EQ(topic_of(topics, record), "fieldcast");
  record.is_late = true;
  EXPECT_EQ(topic_of(topics, record), "fieldcast-late");
  record.kind = RecordKind::kAlarm;
  EXPECT_EQ(topic_of(topics, record), "fieldcast-alarm");
  record.kind = RecordKind::kCatalogue;
  EXPECT_EQ(topic_of(topics, record), "fieldcast-catalogue");
}

TEST(KafkaMessages, TheKeyIsTheDevice) {
  Record record = record_of(seconds(0, 3));
  EXPECT_EQ(key_of("north", record), "north/line/press");
  record.is_late = true;
  EXPECT_EQ(key_of("north", record), "north/line/press");
  record.kind = RecordKind::kCatalogue;
  record.identity = 0x9f3a;
  EXPECT_EQ(key_of("north", record), "north/line/press/9f3a");
}

TEST(KafkaOptions, TheProducerIsIdempotent) {
  KafkaSpec spec;
  spec.servers = {"kafka://127.0.0.1:9092", "kafka://127.0.0.1:9093"};
  spec.acknowledgement = std::chrono::seconds{7};
  const auto conf = kafka_options(spec, "me");
  ASSERT_TRUE(conf) << conf.error();
  EXPECT_EQ(value_of(*conf, "enable.idempotence"), "true");
  EXPECT_EQ(value_of(*conf, "bootstrap.servers"), "127.0.0.1:9092,127.0.0.1:9093");
  EXPECT_EQ(value_of(*conf, "security.protocol"), "plaintext");
  EXPECT_EQ(value_of(*conf, "message.timeout.ms"), "7000");
}

TEST(KafkaOptions, ALoginIsReadFromItsFile) {
  const Folder folder;
  KafkaSpec spec;
  spec.servers = {"tls://a.example:9092"};
  spec.user = "north";
  spec.password_file = folder.file("password");
  EXPECT_THAT(kafka_options(spec, "me").error(), HasSubstr(spec.password_file));
  std::FILE* const file = std::fopen(spec.password_file.c_str(), "w");
  ASSERT_NE(file, nullptr);
  std::fputs("horse\n", file);
  std::fclose(file);
  EXPECT_THAT(kafka_options(spec, "me").error(), HasSubstr("chmod"));
  std::filesystem::permissions(spec.password_file, std::filesystem::perms::owner_read);
  const auto conf = kafka_options(spec, "me");
  ASSERT_TRUE(conf) << conf.error();
  EXPECT_EQ(value_of(*conf, "security.protocol"), "sasl_ssl");
  EXPECT_EQ(value_of(*conf, "sasl.mechanism"), "SCRAM-SHA-512");
  EXPECT_EQ(value_of(*conf, "sasl.username"), "north");
}

TEST(KafkaOptions, AFileOfTlsThatIsMissingIsReported) {
  KafkaSpec spec;
  spec.servers = {"tls://a.example:9092"};
  spec.certificate = "/nowhere/c.pem";
  spec.key = "/nowhere/k.pem";
  EXPECT_THAT(kafka_options(spec, "me").error(), HasSubstr("/nowhere/k.pem"));
}

}  // namespace
}  // namespace fieldcast::forward
