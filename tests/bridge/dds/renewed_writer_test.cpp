#include "bridge/dds/endpoints/renewed_writer.hpp"

#include <gtest/gtest.h>

#include <fastdds/dds/subscriber/SampleInfo.hpp>
#include <set>

#include "bridge/dds/topics/topics.hpp"
#include "tests/bridge/dds/dds_support.hpp"

namespace fieldcast {
namespace {

using namespace std::chrono_literals;
using testing::eventually;
using testing::loopback;

// Takes the reports of one reader: their uptimes, the writers, and the instances that ended.
struct Taken {
  explicit Taken(Domain& domain)
      : reader(domain.reader(kBusStatusTopic, nullptr, dds::StatusMask::none())) {}

  bool has(std::uint64_t number) {
    idl::BusStatus status;
    dds::SampleInfo info;
    while (reader->take_next_sample(&status, &info) == ReturnCode_t::RETCODE_OK) {
      ended += info.instance_state != dds::ALIVE_INSTANCE_STATE ? 1 : 0;
      if (!info.valid_data) continue;
      writers.insert(info.sample_identity.writer_guid());
      last = status.exchanges();
    }
    return last == number;
  }

  dds::DataReader* reader;
  std::set<rtps::GUID_t> writers;
  std::uint64_t last = 0;
  int ended = 0;
};

TEST(RenewedWriter, AnInstanceThatIsWrittenAgainNeverEnds) {
  Domain ours(loopback(), "ours", nullptr), theirs(loopback(), "theirs", nullptr);
  std::atomic<int> matched = 0;
  RenewedWriter writer(
      ours,
      [&ours](dds::DataWriterListener* listener, dds::StatusMask mask) {
        return ours.writer(kBusStatusTopic, "renewed", listener, mask);
      },
      [&matched] { ++matched; }, 2);
  Taken taken(theirs);
  ASSERT_TRUE(eventually([&] { return writer.readers() == 1; }));
  Instant now{1000s};
  idl::BusStatus status;
  status.bus("line");
  // Each round: the next writer is made, replaces the current one, and the former one is removed.
  for (std::uint64_t number = 1; number <= 9; ++number) {
    status.exchanges(number);
    writer.write(&status);
    ASSERT_TRUE(eventually([&] { return taken.has(number); })) << number;
    const int before = matched;
    writer.tidy(now);
    if (number % 3 == 2) {
      ASSERT_TRUE(eventually([&] { return matched > before; })) << number;
    }
    now += RenewedWriter::kOverlap;
  }
  EXPECT_EQ(taken.writers.size(), 3U);
  EXPECT_EQ(taken.ended, 0);
  theirs.remove(taken.reader);
}

}  // namespace
}  // namespace fieldcast
