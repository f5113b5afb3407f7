#include "tools/cli/command/base/command_run.hpp"

#include <gtest/gtest.h>

#include <sstream>

#include "tests/bridge/dds/dds_support.hpp"

namespace fieldcast::cli {
namespace {

using testing::both_clocks, testing::bus_name, testing::bus_of, testing::loopback;

// The bus has a catalogue, but its bridge does not announce that it serves it.
TEST(CommandRun, ABusWithoutABridgeIsWaitedForOnce) {
  constexpr std::size_t kWrites = 5;
  const std::string bus = bus_name("unserved");
  testing::Received received;
  DdsLink link(loopback(), "test", received.handlers());
  link.add_bus(bus_of(bus, kWrites));
  Interrupt interrupt;
  const Connection connection(loopback());
  DomainView domain(connection, interrupt);
  std::istringstream in;
  std::ostringstream out, err;
  CommandRun run(domain, connection, {}, {in, out, err});
  std::vector<ChannelPath> paths;
  std::vector<Errand> errands;
  for (std::size_t i = 0; i < kWrites; ++i) {
    paths.push_back({bus, "d", "c" + std::to_string(i)});
    errands.push_back(channel_write(paths.back(), std::int64_t{1}, {}));
  }
  ASSERT_TRUE(run.learn(paths)) << err.str();
  const Instant begun = instant_now();
  (void)run.execute(std::move(errands));
  EXPECT_GE(instant_now() - begun, kBridgeWait);
  EXPECT_LT(instant_now() - begun, 2 * kBridgeWait);
  std::size_t lines = 0;
  std::istringstream printed(err.str());
  for (std::string line; std::getline(printed, line); ++lines)
    EXPECT_NE(line.find("no bridge that serves " + bus), std::string::npos) << line;
  EXPECT_EQ(lines, kWrites);
  EXPECT_EQ(received.commands.size(), 0u);
}

}  // namespace
}  // namespace fieldcast::cli
