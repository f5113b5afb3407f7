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

}  // namespace
}  // namespace fieldcast::forward
