#include "tools/forward/outlet/prometheus/remote_write.hpp"

#include <gmock/gmock.h>
#include <snappy.h>

#include "schema/remote_write.pb.h"
#include "tests/tools/forward/batch_support.hpp"

namespace fieldcast::forward {
namespace {

using testing::ElementsAre;

SampleBatch batch_of(std::vector<std::pair<Value, Quality>> samples) {
  SampleBatch batch;
  batch.bus = "line";
  batch.device = "press";
  for (auto& [value, quality] : samples) {
    BatchSample sample;
    sample.sequence = batch.samples.size() + 1;
    sample.acquired_at = UtcTime{static_cast<std::int64_t>(sample.sequence) * 1'500'000'000};
    sample.value = std::move(value);
    sample.quality = quality;
    batch.samples.push_back(sample);
  }
  return batch;
}

prometheus::WriteRequest request_of(const std::string& text) {
  prometheus::WriteRequest request;
  EXPECT_TRUE(request.ParseFromString(text));
  return request;
}

std::vector<std::string> labels_of(const prometheus::TimeSeries& series) {
  std::vector<std::string> found;
  for (const auto& label : series.labels()) found.push_back(label.name() + '=' + label.value());
  return found;
}

struct RemoteWrite : testing::Test {
  WriteRequestEncoder encoder{"north"};
};

TEST_F(RemoteWrite, AChannelHasASeriesOfValuesAndOneOfSequences) {
  const auto request = request_of(encoder.encode(
      batch_of({{2.5, Quality::kGood}, {true, Quality::kGood}}), catalogue({"speed"})));
  ASSERT_EQ(request.timeseries_size(), 2);
  EXPECT_THAT(labels_of(request.timeseries(0)),
              ElementsAre("__name__=fieldcast_value", "bus=line", "channel=speed", "device=press",
                          "quality=GOOD", "site=north"));
  EXPECT_EQ(labels_of(request.timeseries(1))[0], "__name__=fieldcast_sequence");
  ASSERT_EQ(request.timeseries(0).samples_size(), 2);
  EXPECT_EQ(request.timeseries(0).samples(0).value(), 2.5);
  EXPECT_EQ(request.timeseries(0).samples(0).timestamp(), 1'500);
  EXPECT_EQ(request.timeseries(0).samples(1).value(), 1);
  EXPECT_EQ(request.timeseries(1).samples(1).value(), 2);
}

TEST_F(RemoteWrite, AQualityIsASeriesOfItsOwn) {
  const auto request = request_of(encoder.encode(
      batch_of({{2.5, Quality::kGood}, {2.5, Quality::kUncertain}}), catalogue({"speed"})));
  EXPECT_EQ(request.timeseries_size(), 4);
}

TEST_F(RemoteWrite, TextsHaveNoSeries) {
  EXPECT_EQ(encoder.encode(batch_of({{std::string("idle"), Quality::kGood}}), catalogue({"state"})),
            "");
}

TEST_F(RemoteWrite, ASampleWithoutATimeIsNotSent) {
  SampleBatch batch = batch_of(
      {{0.0, Quality::kNotYetRead}, {0.0, Quality::kBadNoResponse}, {2.5, Quality::kGood}});
  batch.samples[0].acquired_at = batch.samples[1].acquired_at = {};
  const auto request = request_of(encoder.encode(batch, catalogue({"speed"})));
  ASSERT_EQ(request.timeseries_size(), 2);
  EXPECT_EQ(request.timeseries(0).samples(0).value(), 2.5);
}

// Prometheus refuses the second one, and the rest of its request.
TEST_F(RemoteWrite, OfSamplesWithOneTimeOnlyTheFirstIsSent) {
  SampleBatch batch = batch_of(
      {{2.5, Quality::kBadNoResponse}, {2.5, Quality::kUncertain}, {2.5, Quality::kBadNoResponse}});
  for (BatchSample& each : batch.samples) each.acquired_at = UtcTime{9'000'000'000};
  const std::string text = encoder.encode(batch, catalogue({"speed"}));
  const auto request = request_of(text);
  ASSERT_EQ(request.timeseries_size(), 4);
  for (const auto& series : request.timeseries()) EXPECT_EQ(series.samples_size(), 1);
  EXPECT_EQ(request.timeseries(1).samples(0).value(), 1);
  EXPECT_EQ(encoder.encode(batch, catalogue({"speed"})), text) << "a repetition";
  batch.samples = {batch.samples[2]};
  EXPECT_EQ(encoder.encode(batch, catalogue({"speed"})), "") << "in a later message";
  EXPECT_NE(encoder.encode(batch, catalogue({"level"})), "") << "of another channel";
}

TEST_F(RemoteWrite, RequestsAreJoinedByConcatenation) {
  const std::string one = encoder.encode(batch_of({{2.5, Quality::kGood}}), catalogue({"speed"}));
  EXPECT_EQ(request_of(one + one).timeseries_size(), 4);
}

TEST_F(RemoteWrite, ABodyIsABlockOfSnappy) {
  const std::string text(10'000, 'x');
  std::string unpacked;
  ASSERT_TRUE(snappy::Uncompress(snappy_block(text).data(), snappy_block(text).size(), &unpacked));
  EXPECT_EQ(unpacked, text);
}

}  // namespace
}  // namespace fieldcast::forward
