#include <gtest/gtest.h>

#include <string>

#include "bridge/publish/bus_output.hpp"
#include "tests/bridge/store/scratch.hpp"
#include "tests/bridge/store/store_support.hpp"

namespace fieldcast {
namespace {

// The numbers of meters have up to 12 digits.
TEST(StoreRecorder, StoresTheWholeAddressOfADevice) {
  const test::Scratch scratch;
  const StoreAddress address(scratch.path("store.db"));
  BusSpec bus = test::bus_of("line", {"energy"});
  bus.devices[0].link = {.address = 65535, .long_address = "398192000337"};
  {
    Store store(test::forever(address));
    StoreRecorder(store, bus).put("d", DeviceState::kOnline, test::utc(1));
  }
  const auto connection = open_store(address, IfMissing::kFail);
  std::string stored;
  connection->query("select address from devices", {}, [&](const SqlRow& row) {
    stored = std::get<std::string>(row[0]);
    return true;
  });
  EXPECT_TRUE(stored.ends_with(", 398192000337")) << stored;
}

}  // namespace
}  // namespace fieldcast
