// Sample in the form in which the bridge writes it: the key of each channel is serialized and
// hashed once, and the changing members are written after it. The bytes are those of the generated
// type.
#pragma once

#include <bit>
#include <cstring>
#include <string>

#include "bridge/dds/topics/block.hpp"
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

}  // namespace fieldcast
