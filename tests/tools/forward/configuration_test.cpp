#include "tools/forward/settings/configuration.hpp"

#include <gmock/gmock.h>

#include <fstream>
#include <sstream>

#include "tools/forward/settings/server_address.hpp"

namespace fieldcast::forward {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

LoadedForward load(std::string_view text) {
  config::FileReader reader;
  reader.read = [](const std::string& path) -> tl::expected<std::string, config::FileError> {
    if (path.find("missing") != path.npos) return tl::make_unexpected(config::FileError::kMissing);
    return "text";
  };
  return load_forward_text(text, "forward.yaml", reader);
}

std::vector<std::string> faults(std::string_view text) {
  std::vector<std::string> texts;
  const LoadedForward loaded = load(text);
  if (loaded) return texts;
  for (const config::Fault& fault : loaded.error()) texts.push_back(config::to_text(fault));
  return texts;
}

JetStreamSpec jetstream_of(const std::string& text) {
  const auto loaded = load("site: n\nqueue: { path: q }\njetstream: { " + text + " }\n");
  return loaded ? std::get<JetStreamSpec>(loaded->outlet) : JetStreamSpec{};
}

TEST(ForwardConfiguration, EverythingButSiteAndQueueHasADefault) {
  const auto loaded = load("site: north\nqueue: { path: q.db }\n");
  ASSERT_TRUE(loaded) << config::to_text(loaded.error());
  EXPECT_EQ(loaded->site, "north");
  EXPECT_EQ(loaded->queue, (QueueSpec{"q.db", 1'000'000'000, {}}));
  EXPECT_EQ(loaded->dds, DdsSpec{});
  EXPECT_EQ(loaded->gather, GatherSpec{});
  EXPECT_EQ(loaded->payload, PayloadSpec{});
  EXPECT_EQ(loaded->outlet, OutletSpec(JetStreamSpec{}));
  EXPECT_EQ(loaded->send, SendSpec{});
}

TEST(ForwardConfiguration, EveryKeyIsRead) {
  const auto loaded = load(R"(
site: north
dds: { domain: 7 }
log: { level: debug }
queue: { path: q.db, max-size: 50MB, keep: 7d }
gather: { time: 250ms, samples: 500 }
payload: { format: json, compress: zstd }
send: { in-flight: 16, max-rate: 64kB/s, late-after: 1min }
jetstream:
  servers: [tls://a.example:4222, "tls://b.example:4222"]
  authority: ca.pem
  certificate: c.pem
  key: k.pem
  user: north
  password-file: password
  acknowledgement: 2s
  sample-stream: S
  alarm-stream: A
  bucket: B
  streams: { create: true, replicas: 3, keep: 30d, duplicates: 1h }
)");
  ASSERT_TRUE(loaded) << config::to_text(loaded.error());
  EXPECT_EQ(loaded->dds.domain, 7u);
  EXPECT_EQ(loaded->log.level, LogLevel::kDebug);
  EXPECT_EQ(loaded->queue, (QueueSpec{"q.db", 50'000'000, std::chrono::hours{24 * 7}}));
  EXPECT_EQ(loaded->gather, (GatherSpec{std::chrono::milliseconds{250}, 500}));
  EXPECT_EQ(loaded->payload, (PayloadSpec{PayloadFormat::kJson, true}));
  const auto& jetstream = std::get<JetStreamSpec>(loaded->outlet);
  EXPECT_THAT(jetstream.servers, ElementsAre("tls://a.example:4222", "tls://b.example:4222"));
  EXPECT_EQ(jetstream.authority, "ca.pem");
  EXPECT_EQ(jetstream.certificate, "c.pem");
  EXPECT_EQ(jetstream.key, "k.pem");
  EXPECT_EQ(jetstream.user, "north");
  EXPECT_EQ(jetstream.password_file, "password");
  EXPECT_EQ(jetstream.acknowledgement, std::chrono::seconds{2});
  EXPECT_EQ(jetstream.sample_stream, "S");
  EXPECT_EQ(jetstream.alarm_stream, "A");
  EXPECT_EQ(jetstream.bucket, "B");
  EXPECT_EQ(jetstream.streams,
            (StreamSpec{true, 3, std::chrono::hours{24 * 30}, std::chrono::hours{1}}));
  EXPECT_EQ(loaded->send, (SendSpec{16, 64'000, std::chrono::minutes{1}}));
  EXPECT_EQ(jetstream_of("token-file: t").token_file, "t");
  EXPECT_EQ(jetstream_of("credentials: c").credentials, "c");
}

TEST(ForwardConfiguration, WhatIsMissingIsNamed) {
  EXPECT_THAT(faults("site: north\n"), ElementsAre(HasSubstr("queue")));
  EXPECT_THAT(faults("queue: { path: q.db }\n"), ElementsAre(HasSubstr("site")));
  EXPECT_THAT(faults("site: north\nqueue: { max-size: 1GB }\n"), ElementsAre(HasSubstr("path")));
  EXPECT_THAT(faults("bridge: x\n"), ElementsAre(HasSubstr("not a configuration")));
  EXPECT_THAT(faults(""), ElementsAre(HasSubstr("empty")));
}

std::vector<std::string> jetstream_faults(const std::string& text) {
  return faults("site: n\nqueue: { path: q }\njetstream: { " + text + " }\n");
}

TEST(ForwardConfiguration, AServerOffThisMachineNeedsTls) {
  const auto found = jetstream_faults("servers: [nats://10.0.0.7:4222]");
  ASSERT_EQ(found.size(), 1u);
  EXPECT_THAT(found[0], HasSubstr("forward.yaml:3:24"));
  EXPECT_THAT(found[0], HasSubstr("without TLS"));
  EXPECT_THAT(found[0], HasSubstr("tls://10.0.0.7:4222"));
  EXPECT_TRUE(jetstream_faults("servers: [nats://10.0.0.7:4222], without-tls: true").empty());
  EXPECT_TRUE(jetstream_faults("servers: [nats://localhost:4222, \"nats://[::1]:1\"]").empty());
}

TEST(ForwardConfiguration, ALoginInAnAddressIsRefusedAndNotShown) {
  const auto found = jetstream_faults("servers: [\"tls://ann:secret@a.example:4222\"]");
  ASSERT_EQ(found.size(), 1u);
  EXPECT_THAT(found[0], HasSubstr("password-file"));
}

TEST(ForwardConfiguration, HalfALoginIsRefused) {
  const std::string tls = "servers: [tls://a.example:1], ";
  EXPECT_THAT(jetstream_faults("user: ann"), ElementsAre(HasSubstr("without 'password-file'")));
  EXPECT_THAT(jetstream_faults("password-file: p"), ElementsAre(HasSubstr("without 'user'")));
  EXPECT_THAT(jetstream_faults(tls + "key: k.pem"),
              ElementsAre(HasSubstr("without 'certificate'")));
  EXPECT_THAT(jetstream_faults(tls + "certificate: c.pem"),
              ElementsAre(HasSubstr("without 'key'")));
  EXPECT_THAT(jetstream_faults("token-file: t, credentials: c"),
              ElementsAre(HasSubstr("more than one login")));
  EXPECT_THAT(jetstream_faults("authority: ca.pem"), ElementsAre(HasSubstr("without a server")));
  EXPECT_THAT(jetstream_faults("token-file: missing"), ElementsAre(HasSubstr("missing")));
}

TEST(ForwardConfiguration, NamesThatNatsDoesNotAllowAreRefused) {
  EXPECT_THAT(jetstream_faults("sample-stream: a.b"), ElementsAre(HasSubstr("contains '.'")));
  EXPECT_THAT(jetstream_faults("bucket: a.b"), ElementsAre(HasSubstr("bucket 'a.b'")));
}

std::vector<std::string> outlet_faults(const std::string& section) {
  return faults("site: n\nqueue: { path: q }\n" + section + "\n");
}

TEST(ForwardConfiguration, EveryKeyOfMqttIsRead) {
  const auto loaded = load(R"(
site: north
queue: { path: q.db }
mqtt:
  servers: [mqtts://a.example:8883, "mqtt://[::1]:1883"]
  authority: ca.pem
  certificate: c.pem
  key: k.pem
  user: north
  password-file: password
  version: 3.1.1
  client-id: one
  acknowledgement: 2s
  prefix: plant
  retain: true
  discovery: true
  discovery-prefix: ha
)");
  ASSERT_TRUE(loaded) << config::to_text(loaded.error());
  MqttSpec expected;
  expected.servers = {{"a.example", 8883, true}, {"::1", 1883, false}};
  expected.authority = "ca.pem";
  expected.certificate = "c.pem";
  expected.key = "k.pem";
  expected.user = "north";
  expected.password_file = "password";
  expected.version = MqttVersion::k311;
  expected.client_id = "one";
  expected.acknowledgement = std::chrono::seconds{2};
  expected.prefix = "plant";
  expected.retain = expected.discovery = true;
  expected.discovery_prefix = "ha";
  EXPECT_EQ(std::get<MqttSpec>(loaded->outlet), expected);
}

TEST(ForwardConfiguration, EveryKeyOfSparkplugIsRead) {
  const auto loaded = load(
      "site: north\nqueue: { path: q.db }\nsparkplug: { group: g, edge-node: e, primary-host: "
      "scada, "
      "qos: 1, without-tls: true, servers: [mqtt://a.example:1883] }\n");
  ASSERT_TRUE(loaded) << config::to_text(loaded.error());
  SparkplugSpec expected;
  expected.servers = {{"a.example", 1883, false}};
  expected.without_tls = true;
  expected.group = "g";
  expected.edge_node = "e";
  expected.primary_host = "scada";
  expected.qos = 1;
  EXPECT_EQ(std::get<SparkplugSpec>(loaded->outlet), expected);
}

TEST(ForwardConfiguration, FaultsOfAnMqttServerAreThoseOfEachServer) {
  const auto found = outlet_faults("mqtt: { servers: [mqtt://10.0.0.7:1883] }");
  ASSERT_EQ(found.size(), 1u);
  EXPECT_THAT(found[0], HasSubstr("mqtts://10.0.0.7:1883"));
  EXPECT_THAT(outlet_faults("mqtt: { servers: [nats://127.0.0.1:1] }"),
              ElementsAre(HasSubstr("mqtt:// or mqtts://")));
  EXPECT_THAT(outlet_faults("sparkplug: { user: ann }"),
              ElementsAre(HasSubstr("'user' without 'password-file'")));
  EXPECT_THAT(outlet_faults("sparkplug: { key: k.pem, servers: [mqtts://a.example:8883] }"),
              ElementsAre(HasSubstr("'key' without 'certificate'")));
  EXPECT_THAT(outlet_faults("mqtt: { authority: ca.pem }"), ElementsAre(HasSubstr("mqtts://")));
  EXPECT_THAT(outlet_faults("sparkplug: { primary-host: \"a/b\" }"),
              ElementsAre(HasSubstr("contains '+', '#', '/' or '$'")));
  EXPECT_THAT(outlet_faults("mqtt: {}\nsparkplug: {}"), ElementsAre(HasSubstr("one engine")));
}

PostgresqlSpec postgresql_of(const std::string& text) {
  const auto loaded = load("site: n\nqueue: { path: q }\npostgresql: { " + text + " }\n");
  return loaded ? std::get<PostgresqlSpec>(loaded->outlet) : PostgresqlSpec{.server = "fault"};
}
std::vector<std::string> postgresql_faults(const std::string& text) {
  return faults("site: n\nqueue: { path: q }\npostgresql: { " + text + " }\n");
}

TEST(ForwardConfiguration, EveryKeyOfPostgresqlIsRead) {
  EXPECT_EQ(postgresql_of("create: false"), PostgresqlSpec{});
  EXPECT_EQ(
      postgresql_of("server: \"db.example:5433\", database: plant, user: north, "
                    "password-file: p, authority: a, certificate: c, key: k, without-tls: "
                    "true, schema: s, create: true"),
      (PostgresqlSpec{"db.example:5433", "plant", "north", "p", "a", "c", "k", true, "s", true}));
}

TEST(ForwardConfiguration, APostgresqlServerOffThisMachineNeedsAnAuthority) {
  EXPECT_THAT(postgresql_faults("server: \"db.example:5432\""),
              ElementsAre(HasSubstr("without TLS")));
  EXPECT_TRUE(postgresql_faults("server: \"db.example:5432\", authority: ca.pem").empty());
  EXPECT_TRUE(postgresql_faults("server: \"db.example:5432\", without-tls: true").empty());
  EXPECT_TRUE(postgresql_faults("server: /run/postgresql").empty());
  EXPECT_THAT(postgresql_faults("server: db.example"),
              ElementsAre(HasSubstr("names no host and port")));
  EXPECT_THAT(postgresql_faults("password-file: p"), ElementsAre(HasSubstr("without 'user'")));
  EXPECT_THAT(postgresql_faults("certificate: c"), ElementsAre(HasSubstr("without 'key'")));
}

KafkaSpec kafka_of(const std::string& text) {
  const auto loaded = load("site: n\nqueue: { path: q }\nkafka: { " + text + " }\n");
  return loaded ? std::get<KafkaSpec>(loaded->outlet) : KafkaSpec{.servers = {"fault"}};
}
std::vector<std::string> kafka_faults(const std::string& text) {
  return faults("site: n\nqueue: { path: q }\nkafka: { " + text + " }\n");
}

TEST(ForwardConfiguration, EveryKeyOfKafkaIsRead) {
  EXPECT_EQ(kafka_of("without-tls: false"), KafkaSpec{});
  EXPECT_EQ(kafka_of("servers: [tls://a.example:9092], authority: a, certificate: c, key: k, user: "
                     "north, password-file: p, mechanism: plain, without-tls: true, "
                     "acknowledgement: 9s, topics: { samples: s, late-samples: l, alarms: al, "
                     "catalogues: ca }"),
            (KafkaSpec{{"tls://a.example:9092"},
                       "a",
                       "c",
                       "k",
                       "north",
                       "p",
                       KafkaMechanism::kPlain,
                       true,
                       std::chrono::seconds{9},
                       {"s", "l", "al", "ca"}}));
}

TEST(ForwardConfiguration, ServersOfKafkaAreAllWithTlsOrNone) {
  EXPECT_THAT(kafka_faults("servers: [kafka://10.0.0.7:9092]"),
              ElementsAre(HasSubstr("without TLS")));
  EXPECT_THAT(kafka_faults("servers: [nats://127.0.0.1:9092]"),
              ElementsAre(HasSubstr("does not begin with kafka:// or tls://")));
  EXPECT_THAT(kafka_faults("servers: [kafka://127.0.0.1:9092, tls://a.example:9092]"),
              ElementsAre(HasSubstr("with and without TLS")));
  EXPECT_THAT(kafka_faults("authority: a"), ElementsAre(HasSubstr("without a server tls")));
  EXPECT_THAT(kafka_faults("user: a"), ElementsAre(HasSubstr("without 'password-file'")));
  EXPECT_THAT(kafka_faults("mechanism: md5"), ElementsAre(HasSubstr("scram-sha-512")));
}

InfluxdbSpec influxdb_of(const std::string& text) {
  const auto loaded = load("site: n\nqueue: { path: q }\ninfluxdb: { " + text + " }\n");
  return loaded ? std::get<InfluxdbSpec>(loaded->outlet) : InfluxdbSpec{.database = "fault"};
}
std::vector<std::string> influxdb_faults(const std::string& text) {
  return faults("site: n\nqueue: { path: q }\ninfluxdb: { " + text + " }\n");
}

TEST(ForwardConfiguration, EveryKeyOfInfluxdbIsRead) {
  EXPECT_EQ(influxdb_of("create: false"), InfluxdbSpec{});
  const InfluxdbSpec spec = influxdb_of(
      "server: \"https://a.example:8086/path/\", authority: a, certificate: c, key: k, token-file: "
      "t, without-tls: true, acknowledgement: 9s, database: d, organization: o, bucket: b, create: "
      "true");
  EXPECT_EQ(spec.http, (HttpSpec{"https://a.example:8086/path", "a", "c", "k", "", "", "t", true,
                                 std::chrono::seconds{9}}));
  EXPECT_EQ(spec.database, "d");
  EXPECT_EQ(spec.organization, "o");
  EXPECT_EQ(spec.bucket, "b");
  EXPECT_TRUE(spec.create);
  EXPECT_EQ(influxdb_of("user: u, password-file: p").http.user, "u");
}

TEST(ForwardConfiguration, AnHttpServerOffThisMachineNeedsTls) {
  EXPECT_THAT(influxdb_faults("server: \"http://10.0.0.7:8086\""),
              ElementsAre(HasSubstr("without TLS")));
  EXPECT_TRUE(influxdb_faults("server: \"http://10.0.0.7:8086\", without-tls: true").empty());
  EXPECT_TRUE(influxdb_faults("server: \"https://a.example:8086\"").empty());
  EXPECT_THAT(influxdb_faults("server: \"ftp://a.example:8086\""),
              ElementsAre(HasSubstr("does not begin with http:// or https://")));
  EXPECT_THAT(
      influxdb_faults("server: \"http://ann:horse@a.example:8086\""),
      ElementsAre(testing::AllOf(HasSubstr("password-file"), testing::Not(HasSubstr("horse")))));
  EXPECT_THAT(influxdb_faults("authority: a"), ElementsAre(HasSubstr("without a server https")));
  EXPECT_THAT(influxdb_faults("user: u, password-file: p, token-file: t"),
              ElementsAre(HasSubstr("more than one login")));
  EXPECT_THAT(influxdb_faults("bucket: b"), ElementsAre(HasSubstr("without 'organization'")));
}

TEST(ForwardConfiguration, PrometheusHasTheKeysOfHttp) {
  const auto loaded = load(
      "site: n\nqueue: { path: q }\nprometheus: { server: \"https://a:1/w\", token-file: t }\n");
  ASSERT_TRUE(loaded) << config::to_text(loaded.error());
  const auto& http = std::get<PrometheusSpec>(loaded->outlet).http;
  EXPECT_EQ(http.server, "https://a:1/w");
  EXPECT_EQ(http.token_file, "t");
}

TEST(ForwardConfiguration, OneEngineIsAllowed) {
  EXPECT_THAT(faults("site: n\nqueue: { path: q }\njetstream: {}\npostgresql: {}\n"),
              ElementsAre(HasSubstr("'postgresql' beside 'jetstream'")));
}

TEST(ServerAddress, NamesSchemeHostAndPort) {
  EXPECT_TRUE(server_address_from("tls://a.example:4222")->tls);
  EXPECT_FALSE(server_address_from("tls://a.example:4222")->on_loopback);
  EXPECT_TRUE(server_address_from("nats://127.0.0.9:4222")->on_loopback);
  for (const char* wrong : {"", "a.example:4222", "nats://a.example", "http://a:1", "nats://:1",
                            "nats://127.0.0.1.example:x"})
    EXPECT_FALSE(server_address_from(wrong)) << wrong;
  EXPECT_FALSE(server_address_from("nats://127.evil.example:4222")->on_loopback);
}

TEST(ForwardDocument, ListsEveryKeyWithItsDefault) {
  std::ifstream file(FIELDCAST_SOURCE "/docs/forward.md");
  std::stringstream page;
  page << file.rdbuf();
  for (const DocumentedKey& key : documented_keys()) {
    const std::string row = "| `" + key.name + "` | " + key.fallback + " | ";
    EXPECT_THAT(page.str(), HasSubstr(row));
  }
}

TEST(ForwardConfiguration, CommandsOfSparkplugHaveOneUser) {
  const std::string head = "site: n\nqueue: { path: q }\n";
  const std::string rules = "allow: [{ user: scada, channels: [\"line\"] }] }\n";
  const auto loaded = load(head + "sparkplug: {}\ncommands: { user: scada, " + rules);
  ASSERT_TRUE(loaded) << config::to_text(loaded.error());
  EXPECT_EQ(std::get<SparkplugSpec>(loaded->outlet).command_user, "scada");
  EXPECT_EQ(std::get<SparkplugSpec>(load(head + "sparkplug: {}\n")->outlet).command_user, "");
  EXPECT_THAT(faults(head + "sparkplug: {}\ncommands: { " + rules),
              ElementsAre(HasSubstr("'user' is missing")));
  EXPECT_THAT(faults(head + "commands: { user: scada, " + rules),
              ElementsAre(HasSubstr("NATS names the user")));
  EXPECT_THAT(faults(head + "mqtt: {}\ncommands: { " + rules),
              ElementsAre(HasSubstr("does not carry commands")));
}

}  // namespace
}  // namespace fieldcast::forward
