#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>

#include "bridge/dds/topics/conversion.hpp"
#include "bridge/dds/transport/domain.hpp"
#include "tests/bridge/dds/dds_support.hpp"
#include "tests/bridge/support/role.hpp"

namespace fieldcast::testing {
namespace {

using namespace std::chrono_literals;

constexpr const char* kDomainOfReader = "FIELDCAST_TEST_READER_DOMAIN";
constexpr std::uint64_t kBurst = 6'000;

class FullReader {
 public:
  explicit FullReader(const DdsSpec& spec) : domain_(spec, "full", nullptr) {
    dds::DataReaderQos qos = reader_qos(kCommandResultTopic);
    auto& limits = qos.resource_limits();
    limits.max_instances = limits.max_samples_per_instance = 10;
    limits.max_samples = 100;
    reader_ = domain_.reader(kCommandResultTopic, qos, nullptr, dds::StatusMask::none());
  }
  [[nodiscard]] bool matched() const {
    dds::SubscriptionMatchedStatus status;
    reader_->get_subscription_matched_status(status);
    return status.current_count > 0;
  }

 private:
  Domain domain_;
  dds::DataReader* reader_;
};

// Returns how many results of a burst reach the requesting station, each window of 256 within 2 s.
std::uint64_t results_of_a_burst(const std::string& bus) {
  Station station(loopback(), "operator");
  std::atomic<std::uint64_t> results{0};
  station.on_result([&](const StationResult&) { ++results; });
  for (std::uint64_t sent = 1; sent <= kBurst; ++sent) {
    if (!station.send(write_running(bus))) return results;
    if (sent % 256 != 0) continue;
    const auto deadline = std::chrono::steady_clock::now() + 2s;
    while (results < sent) {
      if (std::chrono::steady_clock::now() > deadline) return results;
      std::this_thread::yield();
    }
  }
  return eventually([&] { return results == kBurst; }) ? kBurst : results.load();
}

TEST(DdsResult, AReaderThatTakesNothingDelaysNobodyElse) {
  const std::string bus = bus_name("full");
  Obedient bridge(bus);
  const FullReader full(loopback());
  ASSERT_TRUE(eventually([&] { return full.matched(); }));
  EXPECT_EQ(results_of_a_burst(bus), kBurst);
  EXPECT_THAT(bridge.received.problems.all(), ::testing::IsEmpty());
}

void play_full_reader() {
  DdsSpec spec;
  spec.domain = static_cast<std::uint32_t>(std::atoi(std::getenv(kDomainOfReader)));
  const FullReader reader(spec);
  if (!eventually([&] { return reader.matched(); })) return;
  std::puts("matched");
  std::fflush(stdout);
  ::pause();
}
const auto* const kFullReader = test::Role::add("full-reader", play_full_reader);

TEST(DdsResult, AReaderWhoseProcessIsStoppedDelaysNobodyElse) {
  const std::string bus = bus_name("stopped");
  Obedient bridge(bus);
  ASSERT_EQ(::setenv(kDomainOfReader, std::to_string(loopback().domain).c_str(), 1), 0);
  test::Process reader = test::play("full-reader");
  ASSERT_THAT(reader.said("matched"), ::testing::HasSubstr("matched"));
  reader.signal(SIGSTOP);
  EXPECT_EQ(results_of_a_burst(bus), kBurst);
  EXPECT_THAT(bridge.received.problems.all(), ::testing::IsEmpty());
}

}  // namespace
}  // namespace fieldcast::testing
