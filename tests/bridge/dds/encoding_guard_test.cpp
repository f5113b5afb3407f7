#include "bridge/dds/library/encoding_guard.hpp"

#include <dlfcn.h>
#include <gtest/gtest.h>

#include <vector>

#include "bridge/dds/library/fastdds.hpp"

namespace fieldcast {
namespace {

// The library alone aborts here: the last reader has left before its message is sent. The lookup
// resolves the symbol as the library's calls do: by name, in link order.
TEST(EncodingGuard, WhatNobodyReceivesIsNotEncoded) {
  guard_encoding();
  void* const first = ::dlsym(RTLD_DEFAULT, encode_symbol());
  ASSERT_NE(first, nullptr);
  void* const of_library = ::dlsym(RTLD_NEXT, encode_symbol());
  ASSERT_NE(of_library, nullptr) << "this version of Fast DDS has no such function";
  EXPECT_NE(first, of_library) << "the library's own is called";
  const auto encode = reinterpret_cast<bool (*)(const void*, const void*, void*,
                                                const std::vector<rtps::GuidPrefix_t>&)>(first);
  EXPECT_FALSE(encode(nullptr, nullptr, nullptr, {}));
}

}  // namespace
}  // namespace fieldcast
