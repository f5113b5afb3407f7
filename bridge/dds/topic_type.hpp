// How our types are given to Fast DDS: the generated TopicDataType made safe.
//
// fastddsgen 2.3 leaves two traps. getKey() works in members of the one type object that all endpoints of a participant share:
// two writers on two threads mix up their keys. deserialize() catches a single exception type and trusts the lengths of what came
// from the network: hostile bytes end the process. Both are closed here; objects of this class may be used from any thread.
#pragma once

#include <exception>

#include "idl/topicsPubSubTypes.h"

namespace fieldcast {

template <class Generated>
class TopicType : public Generated {
 public:
  bool getKey(void* data, eprosima::fastrtps::rtps::InstanceHandle_t* handle, bool force_md5) override {
    thread_local Generated worker;
    return worker.getKey(data, handle, force_md5);
  }

  // Refuses what is longer than the type can be, and whatever the generated code throws (bad lengths, bad encapsulation, no
  // memory).
  bool deserialize(eprosima::fastrtps::rtps::SerializedPayload_t* payload, void* data) override {
    if (payload->length > this->m_typeSize) return false;
    try {
      return Generated::deserialize(payload, data);
    } catch (const std::exception&) { return false; }
  }
};

}  // namespace fieldcast
