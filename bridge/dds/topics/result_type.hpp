// CommandResult in the form in which the bridge writes it: results, and unregister messages of
// their instances.
//
// For the library's history all of them belong to one instance, so it is a ring: a new message
// replaces the oldest one, even if readers have not received it. A slow reader then loses results
// and delays no other. Readers find the true key in the message.
#pragma once

#include "bridge/dds/library/cdr.hpp"
#include "bridge/dds/topics/conversion.hpp"
#include "bridge/dds/topics/topic_type.hpp"

namespace fieldcast {

struct OutgoingResult {
  const idl::CommandResult* message;
  bool note = false;  // an unregister message: only the keys are written
};

class ResultType : public TopicType<idl::CommandResultPubSubType> {
  using Base = TopicType<idl::CommandResultPubSubType>;

 public:
  // The key hash of a message as its readers compute it.
  [[nodiscard]] static Handle hash_of(const idl::CommandResult& message) {
    Handle handle;
    Base().key_of(&message, handle, false);
    return handle;
  }

  bool key_of(const void*, Handle& key, bool) override {
    key = Handle{};
    key.value[0] = 1;  // any value, the same for all
    return true;
  }

  std::uint32_t size_of(const void* data) override {
    return Base::size_of(static_cast<const OutgoingResult*>(data)->message);
  }

  bool to_bytes(const void* data, Payload& payload) override {
    const auto& [message, note] = *static_cast<const OutgoingResult*>(data);
    if (!note) return Base::to_bytes(message, payload);
    try {
      CdrWriter out(payload.data, payload.max_size);
      out.add_keys(*message);
      payload.encapsulation = out.encapsulation();
      payload.length = static_cast<std::uint32_t>(out.size());
    } catch (const CdrFull&) { return false; }
    return true;
  }
};

}  // namespace fieldcast
