#include "bridge/dds/topics/sample_type.hpp"

#include "bridge/dds/topics/conversion.hpp"

namespace fieldcast {

using eprosima::fastcdr::Cdr;
using eprosima::fastcdr::FastBuffer;

SampleKey::SampleKey(std::string_view bus, std::string_view device, std::string_view channel) {
  idl::Sample sample;
  sample.bus() = cut_text(bus, kMaxNameLength);
  sample.device() = cut_text(device, kMaxNameLength);
  sample.channel() = cut_text(channel, kMaxNameLength);
  TopicType<idl::SamplePubSubType>().getKey(&sample, &handle, false);
  std::array<char, 3 * (kMaxNameLength + 16)> space{};
  FastBuffer buffer(space.data(), space.size());
  Cdr cdr(buffer, Cdr::DEFAULT_ENDIAN, Cdr::DDS_CDR);
  cdr.serialize_encapsulation();
  const std::size_t begin = cdr.getSerializedDataLength();
  sample.serializeKey(cdr);
  bytes.assign(space.data() + begin, cdr.getSerializedDataLength() - begin);
}

bool SampleType::serialize(void* data, Payload* payload) {
  const auto& [key, value] = *static_cast<OutgoingSample*>(data);
  FastBuffer buffer(reinterpret_cast<char*>(payload->data), payload->max_size);
  Cdr cdr(buffer, Cdr::DEFAULT_ENDIAN, Cdr::DDS_CDR);
  payload->encapsulation = cdr.endianness() == Cdr::BIG_ENDIANNESS ? CDR_BE : CDR_LE;
  try {
    cdr.serialize_encapsulation();
    char* const behind = cdr.getCurrentPosition();
    if (!cdr.jump(key->bytes.size())) return false;
    std::memcpy(behind, key->bytes.data(), key->bytes.size());
    cdr << static_cast<std::uint32_t>(value->kind);
    switch (value->kind) {
      case idl::VALUE_BOOLEAN: cdr << (value->bits != 0); break;
      case idl::VALUE_STRING: cdr << value->text.c_str(); break;
      default: cdr << value->bits; break;  // the bits of each kind are those of the wire
    }
    cdr << static_cast<std::uint32_t>(value->quality) << value->device_code << value->acquired_at
        << value->sequence;
  } catch (const eprosima::fastcdr::exception::NotEnoughMemoryException&) { return false; }
  payload->length = static_cast<std::uint32_t>(cdr.getSerializedDataLength());
  return true;
}

}  // namespace fieldcast
