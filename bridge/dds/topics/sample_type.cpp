#include "bridge/dds/topics/sample_type.hpp"

#include "bridge/dds/library/cdr.hpp"
#include "bridge/dds/topics/conversion.hpp"

namespace fieldcast {

SampleKey::SampleKey(std::string_view bus, std::string_view device, std::string_view channel) {
  idl::Sample sample;
  sample.bus() = cut_text(bus, kMaxNameLength);
  sample.device() = cut_text(device, kMaxNameLength);
  sample.channel() = cut_text(channel, kMaxNameLength);
  TopicType<idl::SamplePubSubType>().key_of(&sample, handle, false);
  std::array<char, 3 * (kMaxNameLength + 16)> space{};
  CdrWriter out(space.data(), space.size());
  const std::size_t begin = out.size();
  out.add_keys(sample);
  bytes.assign(space.data() + begin, out.size() - begin);
}

bool SampleType::to_bytes(const void* data, Payload& payload) {
  const auto& [key, value] = *static_cast<const OutgoingSample*>(data);
  try {
    CdrWriter out(payload.data, payload.max_size);
    payload.encapsulation = out.encapsulation();
    if (!out.add_bytes(key->bytes)) return false;
    out << static_cast<std::uint32_t>(value->kind);
    switch (value->kind) {
      case idl::ValueKind::VALUE_BOOLEAN: out << (value->bits != 0); break;
      case idl::ValueKind::VALUE_STRING: out << value->text.c_str(); break;
      default: out << value->bits; break;  // the bits of each kind are those on the wire
    }
    out << static_cast<std::uint32_t>(value->quality) << value->device_code << value->acquired_at
        << value->sequence;
    payload.length = static_cast<std::uint32_t>(out.size());
  } catch (const CdrFull&) { return false; }
  return true;
}

}  // namespace fieldcast
