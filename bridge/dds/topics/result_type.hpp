// CommandResult as the bridge writes it: results, and the notes that their instances are let go.
//
// For the library's history all of them are of one instance, so that it is a ring: what does not
// fit pushes the oldest out, whether its readers have it or not. A reader that stays behind then
// loses results and holds nobody up. Readers find the true key in the message.
#pragma once

#include "bridge/dds/cdr.hpp"
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

 public:
  // The key hash of a message, as its readers work it out.
  [[nodiscard]] static Handle hash_of(const idl::CommandResult& message) {
    Handle handle;
    Base().key_of(&message, handle, false);
    return handle;
  }

  bool key_of(const void*, Handle& key, bool) override {
    key = Handle{};
    key.value[0] = 1;  // any, the same for all
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
