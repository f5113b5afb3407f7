#include "tools/forward/payload/json_payload.hpp"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "tests/tools/forward/batch_support.hpp"

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
