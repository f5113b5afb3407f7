// Built with Fast DDS 2.9 only, whose Publisher::create_datawriter() is replaced by one that can
// fail, as without memory.
#include <dlfcn.h>
#include <gtest/gtest.h>

#include <atomic>
#include <fastdds/dds/publisher/Publisher.hpp>

#include "tests/bridge/dds/dds_support.hpp"

namespace {
std::atomic<bool> refuses_writers = false;
}

namespace eprosima::fastdds::dds {

DataWriter* Publisher::create_datawriter(Topic* topic, const DataWriterQos& qos,
                                         DataWriterListener* listener, const StatusMask& mask) {
  using Create = DataWriter* (*)(Publisher*, Topic*, const DataWriterQos&, DataWriterListener*,
                                 const StatusMask&);
  static const auto library = reinterpret_cast<Create>(
      ::dlsym(RTLD_NEXT,
              "_ZN8eprosima7fastdds3dds9Publisher17create_datawriterEPNS1_5TopicERKNS1_"
              "13DataWriterQosEPNS1_18DataWriterListenerERKNS1_10StatusMaskE"));
  return refuses_writers ? nullptr : library(this, topic, qos, listener, mask);
}

}  // namespace eprosima::fastdds::dds

namespace fieldcast::testing {
namespace {

using namespace std::chrono_literals;

// Regression: the bridge ended by an exception on the thread of the publisher.
TEST(DdsLink, KeepsTheRefreshIfNoWriterCanBeCreated) {
  const std::string bus = bus_name("refused-writer");
  Received received;
  DdsLink link(loopback(), "test", received.handlers());
  link.add_bus(bus_of(bus, 2, [](std::size_t) { return 60s; }));
  refuses_writers = true;
  EXPECT_NO_THROW(link.set_refresh(bus, 0, 500ms));
  refuses_writers = false;
  EXPECT_EQ(link.counters(bus).sample_writers, 1u);
  link.set_refresh(bus, 0, 500ms);
  EXPECT_EQ(link.counters(bus).sample_writers, 2u);
}

}  // namespace
}  // namespace fieldcast::testing
