// Tests DDS Security over real DDS on the loopback: who can join, and whose messages are accepted.
//
// Only the receiving side refuses. A forger's own library allows everything here, because its
// signed permissions allow everything in another domain, which Fast DDS 2.9.1 does not check on the
// forger's side.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <fastdds/dds/subscriber/SampleInfo.hpp>
#include <thread>

#include "bridge/dds/library/library.hpp"
#include "bridge/dds/topics/conversion.hpp"
#include "bridge/dds/transport/domain.hpp"
#include "bridge/security/authority.hpp"
#include "bridge/security/file_access.hpp"
#include "bridge/security/member_folder.hpp"
#include "tests/bridge/dds/dds_support.hpp"
#include "tests/bridge/security/scratch_folder.hpp"

namespace fieldcast::testing {
namespace {

using namespace std::chrono_literals;
using enum security::MemberRole;
using security::Authority;
using security::Member;
using ::testing::HasSubstr;

// Longer than a handshake and a match: what has not arrived by then will not arrive.
constexpr auto kLongEnough = 700ms;

UtcTime now() { return both_clocks().utc; }

// Messages of the libraries of both ends; static because the log callback has no object.
Collected<std::string>& said() {
  static Collected<std::string> lines;
  return lines;
}

// Returns whether the other end refused this, for example "writer", "fieldcast/Command".
bool refused_remote(const std::string& kind, const std::string& topic_or_partition) {
  return eventually([&] {
    for (const std::string& line : said().all()) {
      if (line.find("Error checking create remote " + kind) != std::string::npos &&
          line.find('(' + topic_or_partition) != std::string::npos)
        return true;
    }
    return false;
  });
}

class DdsSecurity : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    set_library_lines(
        [](bool, std::string_view, std::string_view text) { said().add(std::string(text)); });
  }
  void SetUp() override { said().clear(); }

  DdsSpec as(const std::string& folder) const {
    DdsSpec spec;
    spec.domain = domain_.number();
    if (!folder.empty()) spec.security = folder;
    return spec;
  }
  DdsSpec as_new(const Member& member) { return as(authority_.add(member, now())); }
  DdsSpec unsigned_one() const { return as(""); }

  // Returns a participant with the rights of `member`, but its library allows those of `claimed`.
  DdsSpec forger(const Member& member, const Member& claimed) {
    const std::string folder = authority_.add(member, now());
    const std::string ca = scratch_.path("ca/");
    const std::string certificate = security::read_file(folder + "/identity.pem");
    const security::CertificateFacts facts = security::read_certificate(certificate);
    const auto rules = [&facts](const Member& of) {
      const std::string text =
          security::permissions_text({of, facts.subject, facts.not_before, facts.not_after});
      const auto begin = text.find("    <allow_rule>"), end = text.find("    <default>");
      return text.substr(begin, end - begin);
    };
    std::string elsewhere = rules(claimed);
    const std::string all = "<id_range><min>0</min><max>230</max></id_range>";
    for (auto at = elsewhere.find(all); at != std::string::npos; at = elsewhere.find(all))
      elsewhere.replace(at, all.size(), "<id>230</id>");
    std::string text =
        security::permissions_text({member, facts.subject, facts.not_before, facts.not_after});
    text.insert(text.find("    <allow_rule>"), elsewhere);
    const security::Identity permissions{security::read_file(ca + "permissions-ca.pem"),
                                         security::read_file(ca + "permissions-ca.key")};
    security::replace(folder + "/permissions.p7s", security::sign(permissions, text), 0644);
    security::replace(folder + "/member.txt", security::member_text(claimed), 0644);
    return as(folder);
  }

  test::ScratchFolder scratch_;
  test::ClaimedDomain domain_;
  Authority authority_ =
      Authority::create(scratch_.path("ca"), security::Protection::kEncrypt, now());
};

class Watching {
 public:
  explicit Watching(const DdsSpec& spec, const std::string& name = "watching")
      : station(spec, name) {
    station.subscribe_samples([this](const StationSample& sample) { samples.add(sample); });
    station.subscribe_channels([this](const StationChannel& channel) { channels.add(channel); });
  }
  [[nodiscard]] bool saw_nothing() const { return samples.size() == 0 && channels.size() == 0; }

  Collected<StationSample> samples;
  Collected<StationChannel> channels;
  Station station;
};

void publish(DdsLink& link, const std::string& bus, std::int64_t value) {
  const std::vector<Sample> samples{good(0, value)};
  link.publish(bus, samples, both_clocks());
}

void send_in_clear(std::uint32_t domain, const rtps::GUID_t& writer, std::uint8_t sequence,
                   const idl::BusStatus& status) {
  TopicType<idl::BusStatusPubSubType> type;
  rtps::SerializedPayload_t payload(type.size_of(&status));
  ASSERT_TRUE(type.to_bytes(&status, payload));
  std::vector<std::uint8_t> bytes{'R', 'T', 'P', 'S', 2, 2, 1, 15};
  const auto add = [&bytes](const auto* begin, std::size_t size) {
    bytes.insert(bytes.end(), begin, begin + size);
  };
  add(writer.guidPrefix.value, 12);
  const std::size_t length = 20 + payload.length;
  const std::uint8_t head[] = {0x15,
                               5,
                               static_cast<std::uint8_t>(length),
                               static_cast<std::uint8_t>(length >> 8),
                               0,
                               0,
                               16,
                               0,
                               0,
                               0,
                               0,
                               0};
  add(head, sizeof head);
  add(writer.entityId.value, 4);
  const std::uint8_t number[] = {0, 0, 0, 0, sequence, 0, 0, 0};
  add(number, sizeof number);
  add(payload.data, payload.length);
  const int file = ::socket(AF_INET, SOCK_DGRAM, 0);
  for (unsigned participant = 0; participant < 64; ++participant) {
    sockaddr_in to{};
    to.sin_family = AF_INET;
    to.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    to.sin_port = htons(static_cast<std::uint16_t>(7411 + 250 * domain + 2 * participant));
    (void)::sendto(file, bytes.data(), bytes.size(), 0, reinterpret_cast<sockaddr*>(&to),
                   sizeof to);
  }
  ::close(file);
}

TEST_F(DdsSecurity, EveryRoleOfAStationReceivesStoredSamples) {
  Received received;
  auto handlers = received.handlers();
  DdsLink* responds = nullptr;
  handlers.on_history = [&](const HistoryRequest& request, const std::string&) {
    HistoryResponse response{.complete = 1};
    response.rows.push_back({.number = {7, 1}, .value = 0.5, .quality = Quality::kGood});
    responds->respond(request, response);
  };
  DdsLink link(as_new({kBridge, "line-1"}), "line-1", std::move(handlers));
  responds = &link;
  const HistoryRequest request{.bus = "b", .until = {1}, .channels = {{"d", "c", {}, {}, {}}}};
  for (const auto role : {kStation, kPlant, kStationReadonly}) {
    Station station(as_new({role, "s" + std::to_string(static_cast<int>(role))}), "s");
    const auto response = station.history(request, 10s);
    ASSERT_TRUE(response) << to_text(response.error());
    EXPECT_EQ(response->rows.size(), 1u);
  }
  Station outsider(unsigned_one(), "outsider");
  EXPECT_FALSE(outsider.history(request, kLongEnough));
}

TEST_F(DdsSecurity, MembersReadAndCommandAndTheBridgeKnowsWhoTheyAre) {
  Obedient bridge("press-1", 1, as_new({kBridge, "line-7", {}}));
  Watching wall(as_new({kStationReadonly, "wall", {}}));
  Station mes(as_new({kPlant, "mes", {}}), "mes");
  publish(bridge.link, "press-1", 42);
  ASSERT_TRUE(eventually([&] { return wall.samples.size() > 0; }));
  EXPECT_EQ(wall.samples.all().front().value, Value{std::int64_t{42}});
  const auto result = mes.execute(write_running("press-1"), 5s);
  ASSERT_TRUE(result) << to_text(result.error());
  EXPECT_EQ(result->state, CommandState::kDone);
  EXPECT_EQ(bridge.received.commands.all().at(0).second.subject, "plant mes");
}

TEST_F(DdsSecurity, WhoHasNoIdentityOrOneOfAnotherAuthoritySeesNothingAndIsNotHeard) {
  Authority other =
      Authority::create(scratch_.path("other"), security::Protection::kEncrypt, now());
  Watching outsider(unsigned_one(), "outsider");
  Watching stranger(as(other.add({kPlant, "mes", {}}, now())), "stranger");
  Obedient bridge("press-1", 1, as_new({kBridge, "line-7", {}}));
  Obedient impostor("press-1", 1, unsigned_one());
  Watching wall(as_new({kStation, "wall", {}}));
  publish(bridge.link, "press-1", 42);
  publish(impostor.link, "press-1", 666);
  // The outsider has matched its like, so it is running and would receive what it may.
  ASSERT_TRUE(eventually([&] { return outsider.samples.size() > 0; }));
  ASSERT_TRUE(eventually([&] { return wall.samples.size() > 0; }));
  EXPECT_FALSE(stranger.station.execute(write_running("press-1"), kLongEnough));
  EXPECT_TRUE(stranger.saw_nothing());
  for (const StationSample& sample : outsider.samples.all())
    EXPECT_EQ(sample.value, Value{std::int64_t{666}}) << "of the impostor alone";
  for (const StationSample& sample : wall.samples.all())
    EXPECT_EQ(sample.value, Value{std::int64_t{42}}) << "of the bridge alone";
  const auto done = outsider.station.execute(write_running("press-1"));
  ASSERT_TRUE(done) << "by the impostor";
  EXPECT_EQ(bridge.received.commands.size(), 0U);
}

TEST_F(DdsSecurity, WhoIsRevokedSeesNothingAndIsNotHeard) {
  const DdsSpec line = as_new({kBridge, "line-7", {}}), wall = as_new({kStation, "wall", {}});
  const DdsSpec mes = as_new({kPlant, "mes", {}});
  const std::string old_list = security::read_file(*mes.security + "/revoked.pem");
  authority_.revoke("mes", now());
  // Its own copy of the list is old, so it does not contain the revocation.
  security::replace(*mes.security + "/revoked.pem", old_list, 0644);
  Watching revoked(mes, "revoked");
  Obedient bridge("press-1", 1, line);
  Watching watching(wall);
  publish(bridge.link, "press-1", 42);
  ASSERT_TRUE(eventually([&] { return watching.samples.size() > 0; }));
  EXPECT_FALSE(revoked.station.execute(write_running("press-1"), kLongEnough));
  EXPECT_TRUE(revoked.saw_nothing());
  EXPECT_EQ(bridge.received.commands.size(), 0U);
}

TEST_F(DdsSecurity, WhoIsRevokedMeanwhileIsLetDownByRunningPrograms) {
  const DdsSpec line = as_new({kBridge, "line-7", {}}), wall = as_new({kStation, "wall", {}});
  const DdsSpec mes = as_new({kPlant, "mes", {}});
  const std::string old_list = security::read_file(*mes.security + "/revoked.pem");
  Obedient bridge("press-1", 1, line);
  Watching watching(wall);
  Watching revoked(mes, "revoked");
  std::atomic<bool> ends = false;
  std::atomic<std::uint64_t> last_begun = 0;
  std::thread publishing([&] {
    while (!ends) {
      const std::uint64_t sequence = ++last_begun;
      const std::vector<Sample> samples{good(0, static_cast<std::int64_t>(sequence), sequence)};
      bridge.link.publish("press-1", samples, both_clocks());
      std::this_thread::sleep_for(5ms);
    }
  });
  ASSERT_TRUE(revoked.station.execute(write_running("press-1"), 5s));
  EXPECT_TRUE(
      eventually([&] { return revoked.samples.size() > 0 && watching.samples.size() > 0; }));
  authority_.revoke("mes", now());
  security::replace(*mes.security + "/revoked.pem", old_list, 0644);
  EXPECT_TRUE(eventually([&] {
    const auto lines = said().all();
    return std::ranges::count(lines, "plant mes is revoked: it is not let in any more") == 2;
  })) << "by the bridge and the station";
  EXPECT_TRUE(eventually([&] { return bridge.link.counters("press-1").block_readers == 1; }));
  // Samples sent before the removal may arrive after it.
  const std::uint64_t last_sent = last_begun;
  const std::size_t seen = watching.samples.size();
  EXPECT_TRUE(eventually([&] { return watching.samples.size() > seen + 100; }));
  for (const StationSample& sample : revoked.samples.all()) EXPECT_LE(sample.sequence, last_sent);
  StationCommand command = write_running("press-1");
  command.lifespan = 100ms;
  EXPECT_FALSE(revoked.station.execute(command, 0s, 300ms));
  ends = true;
  publishing.join();
  EXPECT_EQ(bridge.received.commands.size(), 1U);
  std::uint64_t next = watching.samples.all().front().sequence;
  for (const StationSample& sample : watching.samples.all())
    EXPECT_EQ(sample.sequence, next++) << "the others miss nothing";
}

// An outsider may send this after reading the GUID of a bridge's writer in message headers.
TEST_F(DdsSecurity, SamplesInClearInTheNameOfABridgeAreRefused) {
  Domain bridge(as_new({kBridge, "line-7", {}}), "line-7", nullptr);
  Domain station(as_new({kStation, "wall", {}}), "wall", nullptr);
  dds::DataWriter* writer = bridge.writer(kBusStatusTopic, "line-7");
  dds::DataReader* reader = station.reader(kBusStatusTopic, nullptr, dds::StatusMask::none());
  idl::BusStatus status;
  status.bus("press-1");
  writer->write(&status);
  const auto taken = [reader] {
    idl::BusStatus message;
    dds::SampleInfo info;
    return reader->take_next_sample(&message, &info) == ReturnCode_t::RETCODE_OK
               ? std::optional<std::string>(message.bus())
               : std::nullopt;
  };
  ASSERT_TRUE(eventually([&] { return taken() == "press-1"; }));
  status.bus("forged");
  send_in_clear(domain_.number(), writer->guid(), 2, status);
  std::this_thread::sleep_for(kLongEnough / 2);
  EXPECT_EQ(taken(), std::nullopt);
  EXPECT_TRUE(eventually([&] {
    return std::ranges::any_of(said().all(), [](const std::string& line) {
      return line.starts_with("messages in clear were refused");
    });
  }));
  status.bus("press-2");
  writer->write(&status);
  EXPECT_TRUE(eventually([&] { return taken() == "press-2"; }));
}

TEST_F(DdsSecurity, AReadonlyStationIsNotifiedThatItMayNotCommand) {
  Station wall(as_new({kStationReadonly, "wall", {}}), "wall");
  EXPECT_FALSE(wall.may_command());
  const auto outcome = wall.execute(write_running("press-1"), 0s);
  ASSERT_FALSE(outcome);
  EXPECT_EQ(outcome.error(), StationFault::kNoRight);
  EXPECT_THAT(to_text(outcome), HasSubstr("needs an identity of role plant"));
  EXPECT_FALSE(wall.may_declare_interest());
  try {
    wall.declare_interest("press-1", 1s);
    FAIL();
  } catch (const DdsError& error) {
    EXPECT_THAT(error.what(), HasSubstr("station-readonly wall may not write"));
    EXPECT_THAT(error.what(), HasSubstr("role station or plant"));
  }
}

TEST_F(DdsSecurity, CommandsAndInterestsOfAForgingStationAreNotHeardByTheBridge) {
  const Member wall{kStationReadonly, "wall", {}};
  Obedient bridge("press-1", 1, as_new({kBridge, "line-7", {}}));
  Watching forging(forger(wall, {kPlant, "wall", {}}), "forging");
  forging.station.declare_interest("press-1", 1s);
  publish(bridge.link, "press-1", 42);
  ASSERT_TRUE(eventually([&] { return forging.samples.size() > 0; })) << "it may read";
  const auto result = forging.station.execute(write_running("press-1"), kLongEnough);
  EXPECT_TRUE(refused_remote("writer", "fieldcast/Command"));
  EXPECT_TRUE(refused_remote("writer", "fieldcast/Interest"));
  ASSERT_FALSE(result);
  EXPECT_EQ(result.error(), StationFault::kNoBridge);
  EXPECT_EQ(bridge.received.commands.size(), 0U);
  EXPECT_EQ(bridge.received.interests.size(), 0U);
}

TEST_F(DdsSecurity, APlantIsHeardForItsBusesAlone) {
  Obedient bridge("press-1", 1, as_new({kBridge, "line-7", {}}));
  bridge.link.add_bus(bus_of("mill-1", 1));
  bridge.claim({"press-1", "mill-1"});
  Station mes(as_new({kPlant, "mes", {"press-*"}}), "mes");
  const auto done = mes.execute(write_running("press-1"), 5s);
  ASSERT_TRUE(done) << to_text(done.error());
  EXPECT_EQ(bridge.received.commands.size(), 1U) << "once";
  // Sent by the writer that the bridge uses for press-1.
  StationCommand command = write_running("mill-1");
  command.lifespan = 100ms;
  EXPECT_FALSE(mes.execute(command, 5s, 300ms));
  EXPECT_EQ(bridge.received.commands.size(), 1U);
  bridge.link.remove_bus("press-1");
  bridge.link.ignore_requests("press-1");
  command.bus = "press-1";
  EXPECT_FALSE(mes.execute(command, kLongEnough, 0s));
}

TEST_F(DdsSecurity, APlantThatForgesItsBusesIsRefusedByTheBridge) {
  const Member mes{kPlant, "mes", {"press-*"}};
  Obedient bridge("mill-1", 1, as_new({kBridge, "line-7", {}}));
  for (const Member& claimed : {Member{kPlant, "mes", {"mill-*"}}, Member{kPlant, "mes", {}}}) {
    Member own = mes;
    own.name += std::to_string(claimed.buses.size());
    Watching forging(forger(own, claimed), "forging");
    publish(bridge.link, "mill-1", 42);
    ASSERT_TRUE(eventually([&] { return forging.samples.size() > 0; })) << "it may read";
    const auto result = forging.station.execute(write_running("mill-1"), kLongEnough);
    EXPECT_TRUE(refused_remote("writer", claimed.buses.empty() ? "<empty>" : "mill-*"));
    ASSERT_FALSE(result);
    EXPECT_EQ(result.error(), StationFault::kNoBridge);
  }
  EXPECT_EQ(bridge.received.commands.size(), 0U);
}

TEST_F(DdsSecurity, SamplesAndResultsOfAForgingStationAreRefusedByTheStations) {
  Received received;
  DdsLink bridge(as_new({kBridge, "line-7", {}}), "line-7", received.handlers());
  bridge.add_bus(bus_of("press-1", 1));
  claim(bridge, {"press-1"});
  Received forged;
  DdsLink forging(forger({kStation, "wall", {}}, {kBridge, "wall", {}}), "line-7",
                  forged.handlers());
  forging.add_bus(bus_of("press-1", 1));
  Watching mes(as_new({kPlant, "mes", {}}));
  std::atomic<int> results = 0;
  mes.station.on_result([&](const StationResult&) { ++results; });
  publish(bridge, "press-1", 42);
  publish(forging, "press-1", 666);
  ASSERT_TRUE(eventually([&] { return mes.samples.size() > 0; }));
  const auto sent = mes.station.send(write_running("press-1"), 5s);
  ASSERT_TRUE(sent);
  ASSERT_TRUE(eventually([&] { return received.commands.size() == 1; }));
  const Command asked = received.commands.all().at(0).second;
  for (const char* const topic :
       {"fieldcast/SampleBlock", "fieldcast/CatalogueBlock", "fieldcast/CommandResult"})
    EXPECT_TRUE(refused_remote("writer", topic)) << topic;
  EXPECT_TRUE(refused_remote("reader", "fieldcast/Command"));
  forging.complete("press-1", done(asked), both_clocks());
  publish(forging, "press-1", 667);
  EXPECT_EQ(forged.commands.size(), 0U) << "a command came to one that is no bridge";
  for (const StationSample& sample : mes.samples.all())
    EXPECT_EQ(sample.value, Value{std::int64_t{42}});
  bridge.complete("press-1", done(asked), both_clocks());
  EXPECT_TRUE(eventually([&] { return results > 0; }));
  std::this_thread::sleep_for(kLongEnough / 3);
  EXPECT_EQ(results, 1);
}

TEST_F(DdsSecurity, ARequesterBelongsToTheSubjectThatUsedItFirst) {
  Obedient bridge("press-1", 1, as_new({kBridge, "line-7", {}}));
  Station mes(as_new({kPlant, "mes", {}}), "mes");
  ASSERT_TRUE(mes.execute(write_running("press-1"), 5s));
  Domain other(as_new({kPlant, "scada", {}}), "other", nullptr);
  dds::DataWriter* writer = other.writer(kCommandTopic, "other");
  StationCommand command = write_running("press-1");
  command.command.requester = mes.requester();
  command.command.request_id = 99;
  idl::Command message;
  ASSERT_TRUE(to_idl("press-1", command.command, message));
  ASSERT_TRUE(eventually([&] {
    dds::PublicationMatchedStatus status;
    writer->get_publication_matched_status(status);
    return status.current_count > 0;
  }));
  writer->write(&message);
  ASSERT_TRUE(eventually([&] { return bridge.received.problems.size() > 0; }));
  EXPECT_THAT(bridge.received.problems.all().front(), HasSubstr("another's requester"));
  EXPECT_EQ(bridge.received.commands.size(), 1U);
}

TEST_F(DdsSecurity, AClaimUnderTheNameOfAnotherBridgeIsIgnored) {
  Received received;
  Collected<BridgeClaims> claims;
  Collected<std::string> found, lost;
  auto handlers = received.handlers();
  handlers.bridges.received = [&](const std::string&, const BridgeClaims& one) { claims.add(one); };
  handlers.bridges.found = [&](const std::string& id) { found.add(id); };
  handlers.bridges.lost = [&](const std::string& id) { lost.add(id); };
  const DdsLink watching(as_new({kBridge, "line-9", {}}), "line-9", handlers);
  Domain other(as_new({kBridge, "line-8", {}}), "line-7", nullptr);
  dds::DataWriterQos qos = writer_qos(kBridgeTopic);
  qos.resource_limits().max_instances = 2;
  qos.resource_limits().max_samples = 2;
  dds::DataWriter* const writer = other.writer(kBridgeTopic, qos, "fieldcast-bridge line-7");
  const auto claim = [&](const std::string& name) {
    idl::Bridge message;
    to_idl(BridgeClaims{name, "host", "", UtcTime{1}, {{"press-1", {UtcTime{1}, true}}}}, message);
    writer->write(&message);
  };
  claim("line-7");
  ASSERT_TRUE(eventually([&] { return received.problems.size() > 0; }));
  EXPECT_EQ(received.problems.all().front(),
            "a claim on buses under the name of bridge 'line-7' was ignored: its writer has the "
            "identity of bridge line-8");
  EXPECT_EQ(claims.size(), 0U);
  EXPECT_EQ(lost.all(), found.all());  // nobody waits for it
  claim("line-8");
  ASSERT_TRUE(eventually([&] { return claims.size() > 0; }));
  EXPECT_EQ(claims.all().front().bridge, "line-8");
  claim("line-7");
  EXPECT_TRUE(eventually([&] { return lost.size() == 2; }));
  EXPECT_EQ(claims.size(), 1U);
}

TEST_F(DdsSecurity, WhatIsWrongWithAFolderIsSaid) {
  const auto fault = [](const DdsSpec& spec) -> std::string {
    try {
      Domain domain(spec, "faulty", nullptr);
    } catch (const DdsError& error) { return error.what(); }
    return {};
  };
  EXPECT_THAT(fault(as(scratch_.path("nowhere"))), HasSubstr("there is no folder"));
  EXPECT_THAT(fault(as(scratch_.path("ca"))), HasSubstr("authority's folder"));
  const DdsSpec mes = as_new({kPlant, "mes", {}});
  security::replace(*mes.security + "/permissions.p7s", "nothing\n", 0644);
  EXPECT_THAT(fault(mes), HasSubstr("fieldcast secure check"));
}

}  // namespace
}  // namespace fieldcast::testing
