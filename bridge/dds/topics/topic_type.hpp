// How our types are given to Fast DDS: the generated TopicDataType made safe. Stations may use it
// as it is.
//
// fastddsgen 2.3 leaves three traps, closed here and in AdaptedType (fastdds.hpp):
//  - getKey() works in members of the one type object that all endpoints of a participant share:
//    two threads mix up their keys.
//  - It does not clear its buffer, so that the padding between two strings holds bytes of the key
//    before: one channel gets many instances, and the note that it is gone belongs to none of them.
//  - deserialize() catches a single exception type and trusts lengths that came from the network:
//    hostile bytes end the process.
//
// Objects of this class may be used from any thread.
#pragma once

#include <algorithm>
#include <exception>

#include "bridge/dds/fastdds.hpp"
#include "idl/topicsPubSubTypes.h"

namespace fieldcast {

template <class Generated>
class TopicType : public AdaptedType<Generated> {
  using Base = AdaptedType<Generated>;

 public:
  // The library takes a buffer of that size for each sample that it keeps and enlarges it where
  // needed. Bounds are far above what is usual: a Sample is about 120 bytes and could be 500, a
  // Command 200 and 550 000. Without a key the library enlarges nothing: it is told the bound, and
  // allocates as much as each sample has (topics.cpp).
  TopicType() : largest_(this->first_allocation()) {
    if (this->is_keyed()) this->set_first_allocation(std::min(largest_, kUsualSize));
  }

  // Refuses what is longer than the type can be, and whatever the generated code throws (bad
  // lengths, bad encapsulation, no memory).
  bool from_bytes(typename Base::Payload& payload, void* data) override {
    if (payload.length > largest_) return false;
    try {
      return Base::from_bytes(payload, data);
    } catch (const std::exception&) { return false; }
  }

  // Where a type has a bound, the library takes the first allocation for it and enlarges nothing
  // (Fast DDS 2.9.1, DataWriterImpl::enable): whatever is longer could not be written.
  bool is_bounded() const override { return !this->is_keyed() && Base::is_bounded(); }

  [[nodiscard]] std::uint32_t largest() const { return largest_; }

 private:
  static constexpr std::uint32_t kUsualSize = 256;
  const std::uint32_t largest_;  // bytes of the longest sample, with its encapsulation
};

}  // namespace fieldcast
