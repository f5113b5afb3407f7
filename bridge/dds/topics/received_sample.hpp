// Sample in the form in which a station reads it: parsed from its bytes, without the generated
// code, which copies strings three times. Its handles are those of the generated type, so that they
// agree with other vendors'.
//
// A reader of Fast DDS 2.9.1 reads each message twice (DataReaderHistory): for its key when it
// arrives, and completely when it is taken. The first time, only the bytes of the key are parsed.
#pragma once

#include "bridge/dds/topics/key_cache.hpp"
#include "bridge/dds/topics/topic_type.hpp"
#include "bridge/dds/topics/topic_values.hpp"
#include "bridge/dds/topics/topics.hpp"

namespace fieldcast {

struct ReceivedSample {
  StationSample sample;
  // True if its value and quality are of kinds that the IDL names.
  bool is_known = false;
  // True if the library made it to find the keys of messages: then only the handle is filled.
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

  // Returns false for bytes that are not a Sample. A message that ends early belongs to the
  // instance with empty names, so that it replaces no value.
  bool from_bytes(Payload& payload, void* data) override;
  // REQUIRES: `data` is a message of new_message() that was read last on this thread.
  bool key_of(const void* data, Handle& key, bool) override {
    key = static_cast<const ReceivedSample*>(data)->handle;
    return true;
  }

  [[nodiscard]] std::size_t known_keys() const { return cache_.size(); }

 private:
  // Throws the exceptions of CdrReader.
  [[nodiscard]] Handle handle_of(const Payload& payload);
  // Key hash of the generated type.
  [[nodiscard]] Handle hash_of(std::string_view bus, std::string_view device,
                               std::string_view channel);

  KeyCache cache_;
};

}  // namespace fieldcast
