// Wraps the generated TopicDataType for safe use with Fast DDS; stations may use the generated one.
// Any thread. Fixes three defects of fastddsgen 2.3, here and in AdaptedType:
// - getKey() uses members shared by all endpoints of a participant: threads mix up their keys.
// - It does not clear its buffer: paddings contain bytes of an earlier key, so a channel gets
//   many instances, and its dispose message matches none of them.
// - deserialize() trusts lengths from the network and catches one type of exception: malformed
//   bytes end the process.
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
  // First allocation for each kept sample; the library enlarges it if needed. Bounds are far above
  // usual sizes: a Sample is about 120 bytes and could be 500, a Command 200 and 550 000. Without a
  // key nothing is enlarged, and the library allocates the size of each sample (topics.cpp).
  TopicType() : largest_(this->first_allocation()) {
    if (this->is_keyed()) this->set_first_allocation(std::min(largest_, kUsualSize));
  }

  // Rejects messages that are too long, or for which the generated code throws.
  bool from_bytes(typename Base::Payload& payload, void* data) override {
    if (payload.length > largest_) return false;
    try {
      return Base::from_bytes(payload, data);
    } catch (const std::exception&) { return false; }
  }

  // With a bound the library uses the first allocation as the limit (DataWriterImpl::enable).
  bool is_bounded() const override { return !this->is_keyed() && Base::is_bounded(); }

  [[nodiscard]] std::uint32_t largest() const { return largest_; }

 private:
  static constexpr std::uint32_t kUsualSize = 256;
  const std::uint32_t largest_;  // bytes of the longest sample, with its encapsulation
};

}  // namespace fieldcast
