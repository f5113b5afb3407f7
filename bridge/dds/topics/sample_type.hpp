// Sample in the form in which the bridge writes it: the key of each channel is serialized and
// hashed once. The bytes are those of the generated type.
#pragma once

#include <bit>
#include <cstring>
#include <string>

#include "bridge/dds/library/cdr.hpp"
#include "bridge/dds/topics/block.hpp"
#include "bridge/dds/topics/conversion.hpp"
#include "bridge/dds/topics/topic_type.hpp"

namespace fieldcast {

// The serialized keys of a channel.
struct SampleKey {
  SampleKey() = default;
  SampleKey(std::string_view bus, std::string_view device, std::string_view channel);

  std::string bytes;  // after the encapsulation
  rtps::InstanceHandle_t handle;
};

struct OutgoingSample {
  const SampleKey* key = nullptr;
  const LastValue* value = nullptr;
};

class SampleType : public TopicType<idl::SamplePubSubType> {
 public:
  bool key_of(const void* data, Handle& key, bool) override {
    key = static_cast<const OutgoingSample*>(data)->key->handle;
    return true;
  }

  std::uint32_t size_of(const void* data) override {
    const auto* sample = static_cast<const OutgoingSample*>(data);
    return static_cast<std::uint32_t>(kMostBehindKey + sample->key->bytes.size() +
                                      (sample->value == nullptr ? 0 : sample->value->text.size()));
  }

  bool to_bytes(const void* data, Payload& payload) override;

 private:
  // Encapsulation, kind, value, quality, device code, instant, sequence, the paddings between them,
  // and length and end of a text.
  static constexpr std::size_t kMostBehindKey = 64;
};

// CommandResult in the form in which the bridge writes it: results, and unregister messages of
// their instances. For the library's history all belong to one instance, a ring: a slow reader
// loses the oldest results and delays no other. Readers find the true key in the message.
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
