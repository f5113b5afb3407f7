#include <gtest/gtest.h>

#include "bridge/dds/guard/datagram_guard.hpp"

namespace fieldcast {
namespace {

class NoRefusal : public ::testing::Environment {
  void TearDown() override {
    const RtpsFaultCounts counts = refused_datagrams();
    for (std::size_t i = 0; i < counts.size(); ++i)
      EXPECT_EQ(counts[i], 0U) << to_text(static_cast<RtpsFault>(i));
  }
};

[[maybe_unused]] const auto* const at_the_end =
    ::testing::AddGlobalTestEnvironment(new NoRefusal);  // the framework deletes it

}  // namespace
}  // namespace fieldcast
