#include "tools/station/settings/configuration.hpp"

#include <gmock/gmock.h>

#include <fstream>
#include <sstream>

#include "tools/station/wiring.hpp"

namespace fieldcast::web {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

LoadedStation load(std::string_view text, const std::optional<ListenSpec>& listen = {}) {
  config::FileReader reader;
  reader.read = [](const std::string& path) -> tl::expected<std::string, config::FileError> {
    if (path.find("missing") != path.npos) return tl::make_unexpected(config::FileError::kMissing);
    return "text";
  };
  return load_station_text(text, "station.yaml", reader, listen);
}

std::vector<std::string> faults(std::string_view text,
                                const std::optional<ListenSpec>& listen = {}) {
  std::vector<std::string> texts;
  const LoadedStation loaded = load(text, listen);
  if (loaded) return texts;
  for (const config::Fault& fault : loaded.error()) texts.push_back(config::to_text(fault));
  return texts;
}

TEST(StationConfiguration, EverythingHasADefault) {
  const auto loaded = load("station: hall\n");
  ASSERT_TRUE(loaded);
  EXPECT_EQ(loaded->name, "hall");
  EXPECT_EQ(loaded->web.listen, (ListenSpec{"127.0.0.1", 8090}));
  EXPECT_FALSE(loaded->store);
  EXPECT_FALSE(loaded->web.local_role);
  EXPECT_EQ(loaded->sites, std::vector<DdsSite>{DdsSite{}});
}

TEST(StationConfiguration, AStreamHasTheKeysOfAForwarder) {
  EXPECT_FALSE(load("station: hall\n")->stream);
  const auto loaded = load(R"(
station: hall
stream: { servers: ["tls://nats.example:4222"], authority: ca.pem, user: hall, password-file: p,
          sample-stream: PLANTS }
)");
  ASSERT_TRUE(loaded) << config::to_text(loaded.error());
  ASSERT_TRUE(loaded->stream);
  EXPECT_THAT(loaded->stream->servers, ElementsAre("tls://nats.example:4222"));
  EXPECT_EQ(loaded->stream->user, "hall");
  EXPECT_EQ(loaded->stream->sample_stream, "PLANTS");
  EXPECT_EQ(loaded->stream->site_bucket, "fieldcast-sites");
  EXPECT_FALSE(loaded->stream_commands);
  EXPECT_TRUE(load("stream: { commands: true }\n")->stream_commands);
}

TEST(StationConfiguration, OnlyAStreamJoinsNoDomain) {
  const std::string stream = "stream: { servers: [\"nats://127.0.0.1:4222\"] }\n";
  EXPECT_TRUE(load(stream)->sites.empty());
  EXPECT_EQ(load(stream + "dds: { domain: 7 }\n")->sites.size(), 1u);
  EXPECT_EQ(load("station: hall\n")->sites.size(), 1u);
}

TEST(StationConfiguration, AStreamOffThisMachineNeedsTls) {
  EXPECT_THAT(faults("stream: { servers: [\"nats://nats.example:4222\"] }\n"),
              ElementsAre(HasSubstr("without TLS")));
  EXPECT_THAT(faults("stream: { acknowledgement: 3s }\n"),
              ElementsAre(HasSubstr("acknowledgement")));
}

TEST(StationConfiguration, EveryKeyIsRead) {
  const auto loaded = load(R"(
station: hall
dds: { domain: 7, interfaces: [10.0.0.7], security: none }
log: { level: debug }
web:
  listen: 10.0.0.7:443
  certificate: cert.pem
  key: key.pem
  hosts: [station.plant, "other:444"]
  embed: ["https://wiki.plant"]
  local-role: none
store: { path: hall.db, keep: 7d }
record: { patterns: ["press-shop/*"] }
)");
  ASSERT_TRUE(loaded) << config::to_text(loaded.error());
  EXPECT_EQ(loaded->sites.front().dds.domain, 7u);
  EXPECT_EQ(loaded->log.level, LogLevel::kDebug);
  EXPECT_EQ(loaded->web.listen, (ListenSpec{"10.0.0.7", 443}));
  EXPECT_EQ(loaded->web.certificate, "cert.pem");
  EXPECT_EQ(loaded->web.key, "key.pem");
  EXPECT_THAT(loaded->web.hosts, ElementsAre("station.plant", "other:444"));
  EXPECT_THAT(loaded->web.embed, ElementsAre("https://wiki.plant"));
  EXPECT_EQ(loaded->web.local_role, LocalRole::kNone);
  ASSERT_TRUE(loaded->store);
  EXPECT_EQ(loaded->store->address, "hall.db");
  EXPECT_THAT(loaded->store->samples, ElementsAre("press-shop/*"));
}

TEST(StationConfiguration, NothingIsRecordedUnlessItIsSaid) {
  EXPECT_TRUE(load("store: { path: a.db }\n")->store->samples.empty());
  EXPECT_THAT(load("store: { path: a.db }\nrecord: {}\n")->store->samples, ElementsAre("*"));
  EXPECT_THAT(faults("record: {}\n"),
              ElementsAre("station.yaml:1:9: nothing can be recorded without a store; allowed: "
                          "store: { path: FILE }"));
}

TEST(StationConfiguration, AFaultSaysWhereAndWhatWasMeant) {
  EXPECT_THAT(faults("web:\n  listn: 127.0.0.1:80\n"),
              ElementsAre(HasSubstr("station.yaml:2:3: unknown key 'listn' in 'web'")));
  EXPECT_THAT(faults("web: { listen: localhost:80 }\n"),
              ElementsAre(HasSubstr("did you mean 127.0.0.1:80")));
  EXPECT_THAT(faults("web: { local-role: operatr }\n"),
              ElementsAre(HasSubstr("did you mean operator")));
  EXPECT_THAT(faults("web: { hosts: station.plant }\n"),
              ElementsAre(HasSubstr("did you mean [\"station.plant\"]")));
  EXPECT_THAT(faults("web: { hosts: [\"http://a\"] }\n"),
              ElementsAre(HasSubstr("1:16: hosts: 'http://a' is no name of a host")));
  EXPECT_THAT(faults("web: { embed: [wiki.plant] }\n"),
              ElementsAre(HasSubstr("embed: 'wiki.plant' is no address of a site")));
  EXPECT_THAT(faults("station: s\nplans: [missing.yaml]\n"),
              ElementsAre(HasSubstr("unknown key 'plans'")));
  EXPECT_THAT(faults("store: { path: a.db }\nrecord: { patterns: [\"a/b/c/d\"] }\n"),
              ElementsAre(HasSubstr("2:22: patterns: ")));
  EXPECT_THAT(faults(""), ElementsAre("station.yaml:1:1: the file is empty"));
}

TEST(StationConfiguration, OffTheLoopbackTlsAndALoginAreNeeded) {
  EXPECT_THAT(faults("web: { listen: 10.0.0.7:8090 }\n"),
              ElementsAre(HasSubstr("1:16: the page off the loopback without TLS"),
                          HasSubstr("without a store there are no users")));
  EXPECT_THAT(faults("web: { listen: 10.0.0.7:8090, certificate: c.pem, key: k.pem }\n"),
              ElementsAre(HasSubstr("without a store")));
  EXPECT_THAT(faults("web: { certificate: c.pem }\n"),
              ElementsAre(HasSubstr("1:21: 'certificate' without 'key'")));
  EXPECT_THAT(faults("store: { path: a.db }\nweb: { listen: 10.0.0.7:8090, certificate: c.pem, "
                     "key: k.pem, local-role: viewer }\n"),
              ElementsAre(HasSubstr("a role for everybody off the loopback")));
  EXPECT_THAT(faults("store: { path: a.db }\n"
                     "web: { listen: 0.0.0.0:8090, certificate: c.pem, key: k.pem }\n"),
              ElementsAre(HasSubstr("no name to reach it by")));
  EXPECT_THAT(faults("store: { path: a.db }\n"
                     "web: { listen: 0.0.0.0:8090, certificate: c.pem, key: k.pem, hosts: [a] }\n"),
              ElementsAre());
}

TEST(StationConfiguration, TheCommandLineGoesBeforeTheFile) {
  EXPECT_EQ(load("web: { listen: 10.0.0.7:8090 }\n", ListenSpec{"127.0.0.1", 9})->web.listen,
            (ListenSpec{"127.0.0.1", 9}));
  EXPECT_THAT(faults("station: a\n", ListenSpec{"10.0.0.7", 9}),
              testing::Contains(HasSubstr("without TLS")));
}

TEST(StationConfiguration, SeveralSitesEachHaveADomainOfTheirOwn) {
  const auto loaded = load(R"(
sites:
  - { name: north, dds: { domain: 3, partition: hall } }
  - { name: south, dds: { discovery-servers: ["127.0.0.1:11811", "127.0.0.1:11812"] } }
)");
  ASSERT_TRUE(loaded) << config::to_text(loaded.error());
  ASSERT_EQ(loaded->sites.size(), 2u);
  EXPECT_EQ(loaded->sites[0].name, "north");
  EXPECT_EQ(loaded->sites[0].dds.domain, 3u);
  EXPECT_EQ(loaded->sites[0].dds.partition, "hall");
  EXPECT_EQ(loaded->sites[1].name, "south");
  EXPECT_EQ(loaded->sites[1].dds.discovery_servers.size(), 2u);
}

TEST(StationConfiguration, SitesThatCannotBeDistinguishedAreFaults) {
  EXPECT_THAT(faults("sites: [ { name: a }, { name: a } ]\n"),
              testing::ElementsAre(HasSubstr("site 'a' exists already")));
  EXPECT_THAT(faults("sites: [ { dds: { domain: 1 } } ]\n"),
              testing::ElementsAre(HasSubstr("name")));
  EXPECT_THAT(faults("sites: [ { name: a } ]\ndds: { domain: 1 }\n"),
              testing::ElementsAre(HasSubstr("'dds' and 'sites' in one map")));
  EXPECT_THAT(faults("sites: []\n"), testing::ElementsAre(HasSubstr("sites is empty")));
  EXPECT_THAT(faults("sites: north\n"), testing::ElementsAre(HasSubstr("a list of 1 to 16 sites")));
}

TEST(StationConfiguration, AnAddressToListenAtIsNotAName) {
  EXPECT_EQ(listen_from("127.0.0.1:0"), (ListenSpec{"127.0.0.1", 0}));
  EXPECT_EQ(listen_from("[::1]:80"), (ListenSpec{"::1", 80}));
  EXPECT_FALSE(listen_from("localhost:80"));
  EXPECT_FALSE(listen_from("127.0.0.1"));
}

std::string document(const std::string& name) {
  std::ifstream file(FIELDCAST_SOURCE "/docs/" + name);
  std::ostringstream text;
  text << file.rdbuf();
  return text.str();
}

TEST(StationConfiguration, TheDocumentHasEveryKeyAsTheProgramKnowsIt) {
  const std::string station = document("station.md"), notifications = document("notifications.md");
  for (const DocumentedKey& key : documented_keys()) {
    if (key.name == "web") continue;  // its keys are described there
    const std::string row =
        "| `" + key.name + "` | " + key.fallback + (key.fallback.empty() ? "| " : " | ") + key.text;
    EXPECT_THAT(key.name.starts_with("notify.") ? notifications : station, HasSubstr(row));
  }
}

constexpr std::string_view kNotify = R"(
station: hall
store: { path: s.db }
notify:
  link: https://station.plant/
  mail: { server: "smtp://mail.plant:587", from: station@plant.example, user: u, password-file: p }
  targets:
    - { name: crew, mail: [ann@plant.example, bob@plant.example] }
    - { name: chat, webhook: "https://chat.plant/hook?x=1", secret-file: k }
  rules:
    - name: night
      to: [crew, chat]
      patterns: ["press-shop", "hall/*/level"]
      priority: high
      hours: ["mon-fri 18:00-06:00", sat-sun]
      delay: 30s
      repeat: 15min
      cleared: true
      escalate: [{ after: 15min, to: [chat] }]
  heartbeat: { url: "http://127.0.0.1:9/beat", every: 30s, method: get }
)";

std::string with(std::string_view before, std::string_view after) {
  std::string text(kNotify);
  const std::size_t at = text.find(before);
  EXPECT_NE(at, text.npos) << before;
  return text.replace(at, before.size(), after);
}

TEST(StationNotify, ReadsTargetsAndRules) {
  const auto loaded = load(kNotify);
  ASSERT_TRUE(loaded) << config::to_text(loaded.error());
  const NotifySpec& notify = *loaded->notify;
  EXPECT_EQ(notify.link, "https://station.plant");
  EXPECT_EQ(notify.keep, std::chrono::hours{24});
  ASSERT_EQ(notify.targets.size(), 2u);
  EXPECT_THAT(notify.targets[0].mail, ElementsAre("ann@plant.example", "bob@plant.example"));
  EXPECT_EQ(notify.targets[1].webhook.server, "https://chat.plant/hook?x=1");
  ASSERT_EQ(notify.rules.size(), 1u);
  const NotifyRule& rule = notify.rules[0];
  EXPECT_EQ(rule.priority, AlarmPriority::kHigh);
  EXPECT_EQ(rule.patterns.size(), 2u);
  EXPECT_EQ(rule.hours.size(), 2u);
  EXPECT_EQ(rule.repeat, std::chrono::minutes{15});
  ASSERT_EQ(rule.escalate.size(), 1u);
  EXPECT_THAT(rule.escalate[0].to, ElementsAre("chat"));
  EXPECT_TRUE(notify.heartbeat.get);
  EXPECT_FALSE(load("station: hall\n")->notify);
}

TEST(StationNotify, EachFaultIsReportedAtItsPlace) {
  const std::pair<std::string, const char*> cases[] = {
      {with("store: { path: s.db }\n", ""), "without a store"},
      {with("ann@plant.example", "ann@plant.example>\\r\\nBcc:x"), "is not a mail address"},
      {with("[ann@plant.example, bob@plant.example]", "[ann]"), "'ann' is not a mail address"},
      {with("to: [crew, chat]", "to: [crow]"), "'crow' is not a target"},
      {with("to: [crew, chat]", "to: []"), "to names no target"},
      {with("sat-sun", "saturday"), "'saturday' is not a time of the week"},
      {with("priority: high", "priority: hihg"), "priority 'hihg' is unknown"},
      {with("repeat: 15min", "repeat: 1s"), "repeat"},
      {with("https://chat.plant", "http://chat.plant"), "off this machine and without TLS"},
      {with("https://chat.plant", "https://me:secret@chat.plant"), "contains a login"},
      {with("https://chat.plant", "ftp://chat.plant"), "does not begin with"},
      {with("name: chat, ", "name: crew, "), "the name 'crew' appears twice"},
      {with("smtp://mail", "http://mail"), "server does not begin with smtp://"},
      {with("user: u, ", ""), "'password-file' without 'user'"},
      {with("from: station@plant.example", "from: station"), "is not a mail address"},
      {with("from: station@plant.example, ", ""), "from"},
      {with("after: 15min, to: [chat] }",
            "after: 15min, to: [chat] }, { after: 5min, to: [crew] }"),
       "earlier than the one before"},
      {with("url: \"http://127.0.0.1:9/beat\", ", ""), "one of 'url' and 'url-file'"},
      {with("secret-file: k", "secret-file: missing"), "missing"},
      {with("press-shop", "a/b/c/d"), "patterns"},
  };
  for (const auto& [text, expected] : cases)
    EXPECT_THAT(faults(text), testing::Contains(HasSubstr(expected))) << text;
}

TEST(LocalRole, FollowsFileStoreAndUsers) {
  StationSpec spec;
  EXPECT_EQ(local_role_of(spec, std::nullopt), Role::kViewer);
  spec.store = StoreSpec{};
  EXPECT_EQ(local_role_of(spec, std::nullopt), std::nullopt);
  EXPECT_EQ(local_role_of(spec, 0), Role::kViewer);
  EXPECT_EQ(local_role_of(spec, 1), std::nullopt);
  spec.web.local_role = LocalRole::kOperator;
  EXPECT_EQ(local_role_of(spec, 1), Role::kOperator);
  spec.web.local_role = LocalRole::kNone;
  EXPECT_EQ(local_role_of(spec, 0), std::nullopt);
  spec.web.local_role = LocalRole::kOperator;
  spec.web.listen.host = "10.0.0.7";
  EXPECT_EQ(local_role_of(spec, 0), std::nullopt);
}

std::string with_report(const std::string& report, const std::string& store = "{ path: s.db }") {
  return with("store: { path: s.db }\n",
              (store.empty() ? "" : "store: " + store + "\n") + "reports: [" + report + "]\n");
}

TEST(StationReports, ReadsAReport) {
  const auto loaded = load(with_report(
      "{ name: energy, channels: [\"press-shop/*/power\", hall], by: shift, shifts: [\"05:00\", "
      "\"17:00\"], every: month, at: \"06:30\", format: csv, to: /srv/reports, mail: [crew] }"));
  ASSERT_TRUE(loaded) << config::to_text(loaded.error());
  ASSERT_EQ(loaded->reports.size(), 1u);
  const ReportSpec& report = loaded->reports[0];
  EXPECT_EQ(report.name, "energy");
  EXPECT_EQ(report.channels.size(), 2u);
  EXPECT_EQ(report.by, ReportBy::kShift);
  EXPECT_THAT(report.shifts, ElementsAre(300, 1020));
  EXPECT_TRUE(report.monthly);
  EXPECT_EQ(report.at, 390);
  EXPECT_TRUE(report.csv);
  EXPECT_EQ(report.folder, "/srv/reports");
  EXPECT_THAT(report.mail, ElementsAre("crew"));
}

TEST(StationReports, EachFaultIsReportedAtItsPlace) {
  const std::pair<std::string, const char*> cases[] = {
      {with_report("{ name: a, channels: [x], to: /srv }", ""), "no reports without a store"},
      {with_report("{ name: ../etc/cron, channels: [x], to: /srv }"), "name"},
      {with_report("{ name: a, to: /srv }"), "channels"},
      {with_report("{ name: a, channels: [a/b/c/d], to: /srv }"), "channels: "},
      {with_report("{ name: a, channels: [x] }"), "without a folder and without mail"},
      {with_report("{ name: a, channels: [x], to: reports }"), "is not an absolute path"},
      {with_report("{ name: a, channels: [x], mail: [chat] }"), "'chat' is not a target"},
      {with_report("{ name: a, channels: [x], mail: [ann@plant.example] }"), "is not a target"},
      {with_report("{ name: a, channels: [x], to: /srv, at: \"25:00\" }"), "'25:00' is not a time"},
      {with_report("{ name: a, channels: [x], to: /srv, by: month }"), "a day has no months"},
      {with_report("{ name: a, channels: [x], to: /srv, by: shift, at: \"05:00\" }"),
       "has not ended at this time"},
      {with_report("{ name: a, channels: [x], to: /srv, shifts: [\"14:00\", \"06:00\"] }"),
       "not in the order of time"},
      {with_report("{ name: a, channels: [x], to: /srv }, { name: a, channels: [x], to: /srv }"),
       "appears twice"}};
  for (const auto& [text, what] : cases) {
    const auto found = faults(text);
    ASSERT_FALSE(found.empty()) << text;
    EXPECT_THAT(found[0], HasSubstr(what));
    EXPECT_THAT(found[0], testing::StartsWith("station.yaml:"));
  }
}

}  // namespace
}  // namespace fieldcast::web
