#include "bridge/dds/transport/domain.hpp"

#include <future>

#include "bridge/dds/topics/conversion.hpp"
#include "tests/bridge/dds/dds_support.hpp"

namespace fieldcast {
namespace {

using testing::eventually;
using testing::loopback;

constexpr std::chrono::seconds kLongest{20};  // of a removal; a deadlock would last forever

struct Matched : dds::DataWriterListener {
  void on_publication_matched(dds::DataWriter*,
                              const dds::PublicationMatchedStatus& status) override {
    readers = status.current_count;
  }
  std::atomic<int> readers{0};
};

// Many heartbeats, so that one occurs during the removal; a lagging reader keeps them going.
dds::DataWriterQos busy_writer_qos() {
  TopicRow many = kSampleTopic;
  many.writer = last_of(2000);
  dds::DataWriterQos qos = writer_qos(many);
  set_repair_times(qos, {{0, 5'000'000}, {0, 20'000}, {0, 100'000'000}});
  return qos;
}

// A removal that hangs holds locks that the exit of the process would wait for.
void ends_in_time(std::future<void> removal) {
  if (removal.wait_for(kLongest) == std::future_status::ready) return;
  ADD_FAILURE() << "the removal of a writer hangs";
  std::fflush(nullptr);
  std::_Exit(1);
}

TEST(Domain, AWriterIsRemovedInTheMiddleOfItsHeartbeats) {
  Domain ours(loopback(), "ours", nullptr), theirs(loopback(), "theirs", nullptr);
  dds::DataReader* reader = theirs.reader(kSampleTopic, nullptr, dds::StatusMask::none());
  for (int round = 0; round < 20; ++round) {
    Matched matched;
    dds::DataWriter* writer = ours.writer(kSampleTopic, busy_writer_qos(), "busy", &matched,
                                          dds::StatusMask::publication_matched());
    ASSERT_TRUE(eventually([&] { return matched.readers > 0; }));
    idl::Sample sample;
    for (int i = 0; i < 1000; ++i) {
      sample.channel(std::to_string(i));
      ASSERT_TRUE(is_taken(writer->write(&sample)));
    }
    ends_in_time(std::async(std::launch::async, [&] { ours.remove(writer); }));
  }
  theirs.remove(reader);
}

TEST(Domain, IsLeftInTheMiddleOfHeartbeats) {
  Domain theirs(loopback(), "theirs", nullptr);
  theirs.reader(kSampleTopic, nullptr, dds::StatusMask::none());
  for (int round = 0; round < 5; ++round) {
    Matched matched;
    auto ours = std::make_unique<Domain>(loopback(), "ours", nullptr);
    dds::DataWriter* writer = ours->writer(kSampleTopic, busy_writer_qos(), "busy", &matched,
                                           dds::StatusMask::publication_matched());
    ASSERT_TRUE(eventually([&] { return matched.readers > 0; }));
    idl::Sample sample;
    for (int i = 0; i < 1000; ++i) {
      sample.channel(std::to_string(i));
      ASSERT_TRUE(is_taken(writer->write(&sample)));
    }
    writer->set_listener(nullptr);
    ends_in_time(std::async(std::launch::async, [&] { ours.reset(); }));
  }
}

}  // namespace
}  // namespace fieldcast
