// Built with Fast DDS 2.9 only: no function of 3.x is replaced.
#include "bridge/dds/library/encoding_guard.hpp"

#include <dlfcn.h>
#include <fastdds/rtps/common/CDRMessage_t.h>
#include <gtest/gtest.h>

#include <fastdds/rtps/common/GuidPrefix_t.hpp>
#include <vector>

namespace fieldcast {
namespace {

using eprosima::fastrtps::rtps::CDRMessage_t;
using eprosima::fastrtps::rtps::GuidPrefix_t;

// Resolves the symbol as the library's calls do: by name, in link order.
void* found(void* where) {
  return ::dlsym(where,
                 "_ZNK8eprosima8fastrtps4rtps8security15SecurityManager19encode_rtps_messageERKNS1_"
                 "12CDRMessage_tERS4_RKSt6vectorINS1_12GuidPrefix_tESaIS9_EE");
}

// The library alone aborts here: the last reader has left before its message is sent.
TEST(EncodingGuard, WhatNobodyReceivesIsNotEncoded) {
  guard_encoding();
  void* const first = found(RTLD_DEFAULT);
  ASSERT_NE(first, nullptr) << "this version of Fast DDS has no such function";
  EXPECT_NE(first, found(RTLD_NEXT)) << "the library's own is called";
  const auto encode = reinterpret_cast<bool (*)(const void*, const CDRMessage_t&, CDRMessage_t&,
                                                const std::vector<GuidPrefix_t>&)>(first);
  CDRMessage_t message{64}, encoded{64};
  EXPECT_FALSE(encode(nullptr, message, encoded, {}));
}

}  // namespace
}  // namespace fieldcast
