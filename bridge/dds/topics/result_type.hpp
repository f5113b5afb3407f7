// CommandResult as the bridge writes it: results, and the notes that their instances are let go.
//
// For the library's history all of them are of one instance, so that it is a ring: what does not
// fit pushes the oldest out, whether its readers have it or not. A reader that stays behind then
// loses results and holds nobody up. Readers find the true key in the message.
#pragma once

#include <fastcdr/Cdr.h>
#include <fastcdr/FastBuffer.h>

#include <functional>

#include "bridge/dds/topics/conversion.hpp"
#include "bridge/dds/topics/topic_type.hpp"

namespace fieldcast {

// What its writer is given.
struct OutgoingResult {
  const idl::CommandResult* message;
  bool note = false;  // the instance is let go: the message's keys alone are written
};

class ResultType : public TopicType<idl::CommandResultPubSubType> {
  using Base = TopicType<idl::CommandResultPubSubType>;
  using Payload = rtps::SerializedPayload_t;
  using Handle = rtps::InstanceHandle_t;

 public:
  // The key hash of a message, as its readers work it out.
  [[nodiscard]] static Handle key_of(const idl::CommandResult& message) {
    Base type;
    Handle handle;
    type.getKey(const_cast<idl::CommandResult*>(&message), &handle, false);
    return handle;
  }

  bool getKey(void*, Handle* handle, bool) override {
    *handle = Handle{};
    handle->value[0] = 1;  // any, the same for all
    return true;
  }

  std::function<std::uint32_t()> getSerializedSizeProvider(void* data) override {
    return Base::getSerializedSizeProvider(message_of(data));
  }

  bool serialize(void* data, Payload* payload) override {
    if (!static_cast<OutgoingResult*>(data)->note)
      return Base::serialize(message_of(data), payload);
    using eprosima::fastcdr::Cdr;
    eprosima::fastcdr::FastBuffer buffer(reinterpret_cast<char*>(payload->data), payload->max_size);
    Cdr cdr(buffer, Cdr::DEFAULT_ENDIAN, Cdr::DDS_CDR);
    payload->encapsulation = cdr.endianness() == Cdr::BIG_ENDIANNESS ? CDR_BE : CDR_LE;
    try {
      cdr.serialize_encapsulation();
      message_of(data)->serializeKey(cdr);
    } catch (const eprosima::fastcdr::exception::NotEnoughMemoryException&) { return false; }
    payload->length = static_cast<std::uint32_t>(cdr.getSerializedDataLength());
    return true;
  }

 private:
  // The library's functions take what they only read without const.
  static idl::CommandResult* message_of(void* data) {
    return const_cast<idl::CommandResult*>(static_cast<OutgoingResult*>(data)->message);
  }
};

}  // namespace fieldcast
