#include <gmock/gmock.h>

#include <limits>

#include "bridge/dds/topics/history.hpp"

namespace fieldcast {
namespace {

HistoryRequest asked() {
  return {.requester = "station:1",
          .request_id = 7,
          .bus = "line",
          .until = {1'000},
          .rows = 100,
          .channels = {{"d", "a", {5}, {7, 3}, {8, 1}}, {"d", "b", {}, {}, {}}}};
}

HistoryRow row(std::uint32_t channel, std::uint64_t sequence, Value value) {
  return {.channel = channel,
          .number = {7, sequence},
          .published_at = {20},
          .acquired_at = {10},
          .value = std::move(value),
          .quality = Quality::kBadDeviceError,
          .device_code = 6};
}

idl::HistoryRequest message() {
  idl::HistoryRequest out;
  to_idl(asked(), out);
  return out;
}

TEST(HistoryConversion, ARequestComesBackAsItWas) {
  const auto back = from_idl(message());
  ASSERT_TRUE(back);
  EXPECT_EQ(back->requester, "station:1");
  EXPECT_EQ(back->request_id, 7u);
  EXPECT_EQ(back->until, UtcTime{1'000});
  EXPECT_EQ(back->rows, 100u);
  EXPECT_EQ(back->channels, asked().channels);
}

TEST(HistoryConversion, ARequestOutOfItsRangeIsRejected) {
  const auto rejected = [](auto change) {
    idl::HistoryRequest hostile = message();
    change(hostile);
    return !from_idl(hostile);
  };
  EXPECT_TRUE(rejected([](auto& request) { request.rows(0); }));
  EXPECT_TRUE(rejected([](auto& request) { request.rows(1025); }));
  EXPECT_TRUE(rejected([](auto& request) { request.requester() = ""; }));
  EXPECT_TRUE(rejected([](auto& request) { request.until(-1); }));
  EXPECT_TRUE(rejected([](auto& request) { request.channels().clear(); }));
  EXPECT_TRUE(rejected([](auto& request) { request.channels().resize(129); }));
  EXPECT_TRUE(rejected([](auto& request) { request.channels()[0].since(-1); }));
  EXPECT_TRUE(rejected([](auto& request) {
    request.channels()[0].epoch(std::numeric_limits<std::uint64_t>::max());
  }));
  EXPECT_TRUE(rejected([](auto& request) { request.channels()[1].until_sequence(1ULL << 63); }));
}

TEST(HistoryConversion, AResponseInPartsComesBackAsItWas) {
  HistoryResponse response{.complete = 1};
  for (std::uint64_t i = 1; i <= 50; ++i) {
    response.rows.push_back(row(0, 2 * i, static_cast<double>(i)));
    response.rows.push_back(row(1, 2 * i + 1, std::string(200, 'x')));
  }
  for (const std::size_t most_bytes : {1'300u, 32'000u}) {
    HistoryParts parts(asked());
    idl::HistoryBlock memory;
    std::size_t blocks = 0;
    auto added = HistoryParts::Added::kMore;
    to_blocks(asked(), response, most_bytes, memory, [&](const idl::HistoryBlock& block) {
      EXPECT_EQ(added, HistoryParts::Added::kMore);
      EXPECT_EQ(block.request_id(), 7u);
      added = parts.add(block);
      ++blocks;
    });
    EXPECT_EQ(added, HistoryParts::Added::kWhole);
    EXPECT_EQ(blocks > 1, most_bytes == 1'300u);
    const HistoryResponse back = parts.take();
    EXPECT_EQ(back.rows, response.rows);
    EXPECT_EQ(back.complete, 1u);
  }
}

TEST(HistoryConversion, ARefusalIsOneBlockWithItsReason) {
  idl::HistoryBlock memory;
  HistoryParts parts(asked());
  to_blocks(asked(), {.outcome = HistoryOutcome::kNoStore, .reason = "no store"}, 1'300, memory,
            [&](const idl::HistoryBlock& block) {
              EXPECT_EQ(parts.add(block), HistoryParts::Added::kWhole);
            });
  const HistoryResponse back = parts.take();
  EXPECT_EQ(back.outcome, HistoryOutcome::kNoStore);
  EXPECT_EQ(back.reason, "no store");
}

TEST(HistoryConversion, AHostileBlockIsRejected) {
  const auto added = [](auto change) {
    idl::HistoryBlock memory;
    HistoryParts parts(asked());
    auto result = HistoryParts::Added::kMore;
    to_blocks(asked(), {.rows = {row(0, 1, 0.5), row(1, 2, std::string("x"))}}, 32'000, memory,
              [&](idl::HistoryBlock& block) {
                change(block);
                result = parts.add(block);
              });
    return result;
  };
  using Added = HistoryParts::Added;
  EXPECT_EQ(added([](auto&) {}), Added::kWhole);
  EXPECT_EQ(added([](auto& block) { block.part(1); }), Added::kOther) << "the first one was lost";
  EXPECT_EQ(added([](auto& block) { block.values().pop_back(); }), Added::kOther);
  EXPECT_EQ(added([](auto& block) { block.channels()[1] = 2; }), Added::kOther);
  EXPECT_EQ(added([](auto& block) { block.values()[1] = 1; }), Added::kOther) << "no such text";
  EXPECT_EQ(added([](auto& block) { block.kinds()[0] = 9; }), Added::kOther);
  EXPECT_EQ(added([](auto& block) { block.qualities()[0] = 99; }), Added::kOther);
  EXPECT_EQ(added([](auto& block) { block.complete(3); }), Added::kOther);
  EXPECT_EQ(added([](auto& block) { block.outcome(static_cast<idl::HistoryOutcome>(9)); }),
            Added::kOther);
}

}  // namespace
}  // namespace fieldcast
