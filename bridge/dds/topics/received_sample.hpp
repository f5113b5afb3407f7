// Sample as a station reads it: by its bytes, without the generated code, whose strings are copied
// three times. Its handles are those of the generated type, so that they agree with other vendors'.
//
// A reader of Fast DDS 2.9.1 reads each message twice (DataReaderHistory): for its key when it
// arrives, and whole when it is taken. The first time only the bytes of the key are looked at.
#pragma once

#include "bridge/dds/topics/key_cache.hpp"
#include "bridge/dds/topics/topic_type.hpp"
#include "bridge/dds/topics/topic_values.hpp"
#include "bridge/dds/topics/topics.hpp"

namespace fieldcast {

// What its reader takes into.
struct ReceivedSample {
  StationSample sample;
  // Its value and quality are of kinds that the IDL names.
  bool is_known = false;
  // Made by the library to find the keys of messages: it gets the handle, and nothing else.
  bool for_key = false;
  rtps::InstanceHandle_t handle;
};

class ReceivedSampleType : public TopicType<idl::SamplePubSubType> {
  using Base = TopicType<idl::SamplePubSubType>;

 public:
  using Message = ReceivedSample;

  explicit ReceivedSampleType(std::size_t keys = kMaxChannels) : cache_(keys) {}

  void* new_message() override { return new ReceivedSample{.for_key = true}; }
  void delete_message(void* message) override { delete static_cast<ReceivedSample*>(message); }

  // False for bytes that are no Sample. A message that ends early is of the instance with empty
  // names, so that it replaces nobody's value.
  bool from_bytes(Payload& payload, void* data) override;
  // REQUIRES: data is a message of new_message() that was read last on this thread.
  bool key_of(const void* data, Handle& key, bool) override {
    key = static_cast<const ReceivedSample*>(data)->handle;
    return true;
  }

  [[nodiscard]] std::size_t known_keys() const { return cache_.size(); }

 private:
  // Throws what CdrReader throws.
  [[nodiscard]] Handle handle_of(const Payload& payload);
  // Of the generated type.
  [[nodiscard]] Handle hash_of(std::string_view bus, std::string_view device,
                               std::string_view channel);

  KeyCache cache_;
};

}  // namespace fieldcast
