#include "tools/forward/payload/json_payload.hpp"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "tests/tools/forward/batch_support.hpp"
#include "tools/forward/payload/codec.hpp"
#include "tools/forward/payload/json_decoder.hpp"

namespace fieldcast::forward {
namespace {

TEST(JsonPayload, SamplesHaveTheirNames) {
  SampleBatch batch{"line", "press", 255, 1, {}};
  batch.samples.push_back({.channel = 1,
                           .sequence = 3,
                           .acquired_at = {1'764'360'000'000'000'001},
                           .value = std::uint64_t{18'446'744'073'709'551'615u}});
  batch.samples.push_back({.channel = 0,
                           .sequence = 4,
                           .acquired_at = {5},
                           .value = std::string("a\"b"),
                           .quality = Quality::kBadDeviceError,
                           .device_code = 2});
  batch.samples.push_back({.channel = 2});
  const auto json = nlohmann::json::parse(to_json("north", batch, catalogue({"a", "b"})));
  EXPECT_EQ(json["schema"], 1);
  EXPECT_EQ(json["site"], "north");
  EXPECT_EQ(json["bus"], "line");
  EXPECT_EQ(json["device"], "press");
  EXPECT_EQ(json["epoch"], "ff");
  ASSERT_EQ(json["samples"].size(), 2u) << "the catalogue has two channels";
  EXPECT_EQ(json["samples"][0]["channel"], "b");
  EXPECT_EQ(json["samples"][0]["value"], 18'446'744'073'709'551'615u);
  EXPECT_EQ(json["samples"][0]["acquired_at"], 1'764'360'000'000'000'001);
  EXPECT_EQ(json["samples"][0]["quality"], "GOOD");
  EXPECT_FALSE(json["samples"][0].contains("device_code"));
  EXPECT_EQ(json["samples"][1]["value"], "a\"b");
  EXPECT_EQ(json["samples"][1]["quality"], "BAD_DEVICE_ERROR");
  EXPECT_EQ(json["samples"][1]["device_code"], 2);
}

TEST(JsonPayload, IsReadBack) {
  SampleBatch batch{"line", "press", 255, 0xF0000000000000FF, {}};
  const Value values[] = {Value{true},
                          Value{5.0},
                          Value{1e300},
                          Value{std::int64_t{-3}},
                          Value{18'446'744'073'709'551'615u},
                          Value{std::string("a\"\n\u00B0")}};
  for (const Value& value : values)
    batch.samples.push_back({.channel = 1,
                             .sequence = batch.samples.size() + 1,
                             .acquired_at = {1'764'360'000'000'000'001},
                             .value = value});
  batch.samples.back().quality = Quality::kBadDeviceError;
  batch.samples.back().device_code = 65'535;
  const DeviceCatalogue made = catalogue({"a", "b"});
  const auto payload = JsonPayload::parse(to_json("north", batch, made));
  ASSERT_TRUE(payload);
  EXPECT_EQ(payload->schema(), kSchema);
  auto samples = payload->samples();
  ASSERT_TRUE(samples);
  EXPECT_EQ(samples->channels, std::vector<std::string>(batch.samples.size(), "b"));
  for (BatchSample& sample : samples->batch.samples) sample.channel = 1;
  EXPECT_EQ(samples->batch.samples, batch.samples);
  EXPECT_EQ(samples->batch.epoch, batch.epoch);
  EXPECT_EQ(samples->batch.catalogue, batch.catalogue);
  const auto read = JsonPayload::parse(to_json("north", made))->catalogue();
  ASSERT_TRUE(read);
  EXPECT_EQ(identity_of(*read), identity_of(made));
  const auto again = JsonPayload::parse(to_json("north", alarm()))->alarm();
  ASSERT_TRUE(again);
  EXPECT_EQ(again->alarm, alarm().alarm);
  EXPECT_EQ(again->status, alarm().status);
}

TEST(JsonPayload, ADamagedTextIsRefused) {
  EXPECT_FALSE(JsonPayload::parse("{"));
  EXPECT_FALSE(JsonPayload::parse("[1]"));
  EXPECT_FALSE(JsonPayload::parse("{}")->schema());
  const std::string good =
      to_json("north", SampleBatch{"line", "press", 1, 2, {{.channel = 0}}}, catalogue({"a"}));
  EXPECT_TRUE(JsonPayload::parse(good)->samples());
  for (const auto& [from, to] :
       {std::pair{"\"epoch\"", "\"x\""}, std::pair{"\"GOOD\"", "\"FINE\""},
        std::pair{"\"NOT_YET_READ\"", "7"}, std::pair{"\"value\":", "\"value\":[],\"x\":"},
        std::pair{"\"sequence\":", "\"sequence\":-1,\"x\":"},
        std::pair{"\"samples\":[", "\"samples\":[7,"}}) {
    std::string bad = good;
    const auto at = bad.find(from);
    if (at == bad.npos) continue;  // the other quality
    bad.replace(at, std::string(from).size(), to);
    EXPECT_FALSE(JsonPayload::parse(bad)->samples()) << bad;
  }
}

TEST(JsonPayload, ACatalogueHasTheIdentityOfItsBatches) {
  const DeviceCatalogue made = catalogue({"a"});
  const auto json = nlohmann::json::parse(to_json("north", made));
  EXPECT_EQ(json["catalogue"], hex_text(identity_of(made)));
  EXPECT_EQ(json["channels"][0]["channel"], "a");
  EXPECT_EQ(json["channels"][0]["unit"], "°C");
  EXPECT_EQ(json["channels"][0]["refresh"], 1'000'000'000);
  EXPECT_TRUE(json["channels"][0]["high"].is_null());
}

TEST(JsonPayload, AnAlarmHasItsStateAndItsPauses) {
  const auto json = nlohmann::json::parse(to_json("north", alarm()));
  EXPECT_EQ(json["limit"], "high-high");
  EXPECT_EQ(json["stage"], "acknowledged");
  EXPECT_EQ(json["active"], true);
  EXPECT_EQ(json["shelved"]["until"], 8'000'000'000);
  EXPECT_TRUE(json["suppressed"].is_null());
}

TEST(JsonPayload, TheAuditHasAllFields) {
  const auto json = nlohmann::json::parse(to_json("north", audit()));
  EXPECT_EQ(json, (nlohmann::json{{"schema", 1},
                                  {"site", "north"},
                                  {"bridge", "plant"},
                                  {"epoch", "7"},
                                  {"number", 3},
                                  {"at", 1'764'360'000'000'000'001},
                                  {"who", "fieldcast/anna"},
                                  {"what", "write 21.5"},
                                  {"target", "line/press/setpoint"},
                                  {"bytes_to_device", 8},
                                  {"bytes_from_device", 9},
                                  {"result", "done"}}));
}

}  // namespace
}  // namespace fieldcast::forward
