// Wraps the generated TopicDataType for safe use with Fast DDS. Stations may use the generated type
// directly.
//
// Code of fastddsgen 2.3 has three defects, fixed here and in AdaptedType (fastdds.hpp):
// - getKey() uses members of the one type object that all endpoints of a participant share: two
//   threads mix up their keys.
// - It does not clear its buffer, so that the padding between two strings contains bytes of an
//   earlier key: one channel gets many instances, and its dispose message matches none of them.
// - deserialize() catches a single exception type and trusts lengths from the network: malformed
//   bytes end the process.
//
// Objects of this class may be used from any thread.
#pragma once

#include <algorithm>
#include <exception>

#include "bridge/dds/library/fastdds.hpp"
#include "idl/topicsPubSubTypes.h"

namespace fieldcast {

template <class Generated>
class TopicType : public AdaptedType<Generated> {
  using Base = AdaptedType<Generated>;

 public:
  // The library allocates a buffer of that size for each sample that it keeps, and enlarges it if
  // needed. Bounds are far above usual sizes: a Sample is about 120 bytes and could be 500, a
  // Command 200 and 550 000. Without a key the library enlarges nothing: then the bound is set, and
  // the library allocates the size of each sample (topics.cpp).
  TopicType() : largest_(this->first_allocation()) {
    if (this->is_keyed()) this->set_first_allocation(std::min(largest_, kUsualSize));
  }

  // Rejects messages that are longer than the type can be, and messages for which the generated
  // code throws (bad lengths, bad encapsulation, no memory).
  bool from_bytes(typename Base::Payload& payload, void* data) override {
    if (payload.length > largest_) return false;
    try {
      return Base::from_bytes(payload, data);
    } catch (const std::exception&) { return false; }
  }

  // If a type has a bound, the library uses the first allocation as the limit and enlarges nothing
  // (Fast DDS 2.9.1, DataWriterImpl::enable): longer messages could not be written.
  bool is_bounded() const override { return !this->is_keyed() && Base::is_bounded(); }

  [[nodiscard]] std::uint32_t largest() const { return largest_; }

 private:
  static constexpr std::uint32_t kUsualSize = 256;
  const std::uint32_t largest_;  // bytes of the longest sample, with its encapsulation
};

}  // namespace fieldcast
