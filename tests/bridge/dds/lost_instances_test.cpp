#include <gtest/gtest.h>

#include <string>

#include "bridge/dds/receivers/taker.hpp"

namespace fieldcast {
namespace {

dds::InstanceHandle_t handle(std::uint8_t number) {
  dds::InstanceHandle_t made;
  made.value[15] = number;
  return made;
}
const auto kWriter = handle(1), kOther = handle(2);

TEST(LostInstances, AWriterThatReturnsHasWhatItHadWritten) {
  LostInstances<std::string> lost(10);
  lost.keep(kWriter, handle(3), "three");
  lost.keep(kWriter, handle(4), "four");
  lost.keep(kOther, handle(5), "five");
  const auto again = lost.take(kWriter);
  ASSERT_EQ(again.size(), 2U);
  EXPECT_EQ(again.at(handle(3)), "three");
  EXPECT_TRUE(lost.take(kWriter).empty()) << "once";
  EXPECT_EQ(lost.take(kOther).size(), 1U);
  EXPECT_EQ(lost.size(), 0U);
}

TEST(LostInstances, WhatALaterMessageReplacedDoesNotReturn) {
  LostInstances<std::string> lost(10);
  lost.keep(kWriter, handle(3), "three");
  lost.keep(kWriter, handle(4), "four");
  lost.forget(kWriter, handle(3));
  lost.forget(kOther, handle(4));
  EXPECT_EQ(lost.size(), 1U);
  EXPECT_EQ(lost.take(kWriter).count(handle(4)), 1U);
}

TEST(LostInstances, TheWriterThatWasLostFirstMakesRoom) {
  LostInstances<int> lost(100);
  for (std::uint8_t writer = 1; writer <= 200; ++writer)
    for (std::uint8_t instance = 0; instance < 10; ++instance)
      lost.keep(handle(writer), handle(instance), writer);
  EXPECT_EQ(lost.size(), 100U);
  EXPECT_TRUE(lost.take(handle(190)).empty());
  EXPECT_EQ(lost.take(handle(191)).size(), 10U);
  EXPECT_EQ(lost.take(handle(200)).size(), 10U);
}

TEST(LostInstances, OneWriterWithMoreThanThereIsRoomForIsForgotten) {
  LostInstances<int> lost(5);
  for (std::uint8_t instance = 0; instance < 6; ++instance) lost.keep(kWriter, handle(instance), 0);
  EXPECT_EQ(lost.size(), 0U);
  lost.keep(kWriter, handle(9), 0);
  EXPECT_EQ(lost.take(kWriter).size(), 1U);
}

}  // namespace
}  // namespace fieldcast
