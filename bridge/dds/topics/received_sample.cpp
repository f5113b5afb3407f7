#include "bridge/dds/topics/received_sample.hpp"

#include "bridge/dds/library/cdr.hpp"
#include "bridge/dds/topics/conversion.hpp"

namespace fieldcast {

namespace {

void read_text(CdrReader& in, std::size_t bound, std::string& out) {
  out = in.text().substr(0, bound);
}

template <class Number>
Number number(CdrReader& in) {
  Number number{};
  in >> number;
  return number;
}

// Returns false for a kind that the IDL does not name; the rest of the message cannot be read then.
bool read_value(CdrReader& in, Value& out) {
  switch (static_cast<idl::ValueKind>(number<std::uint32_t>(in))) {
    case idl::ValueKind::VALUE_BOOLEAN: out = number<bool>(in); return true;
    case idl::ValueKind::VALUE_INT64: out = number<std::int64_t>(in); return true;
    case idl::ValueKind::VALUE_UINT64: out = number<std::uint64_t>(in); return true;
    case idl::ValueKind::VALUE_DOUBLE: out = number<double>(in); return true;
    case idl::ValueKind::VALUE_STRING:
      out = std::string(in.text().substr(0, kMaxTextValue));
      return true;
  }
  return false;
}

// Returns true if kind and quality are known.
bool read_sample(CdrReader& in, StationSample& out) {
  read_text(in, kMaxNameLength, out.bus);
  read_text(in, kMaxNameLength, out.device);
  read_text(in, kMaxNameLength, out.channel);
  if (!read_value(in, out.value)) return false;
  const auto quality = fieldcast::from_idl(static_cast<idl::Quality>(number<std::uint32_t>(in)));
  if (quality) out.quality = *quality;
  in >> out.device_code >> out.acquired_at.nanoseconds >> out.sequence;
  return quality.has_value();
}

}  // namespace

bool ReceivedSampleType::from_bytes(Payload& payload, void* data) {
  auto& message = *static_cast<ReceivedSample*>(data);
  if (payload.length > largest()) return false;
  try {
    if (message.for_key) {
      message.handle = handle_of(payload);
    } else {
      CdrReader in(payload.data, payload.length);
      message.is_known = read_sample(in, message.sample);
    }
    return true;
  } catch (const std::exception&) {
    if (message.for_key) message.handle = hash_of({}, {}, {});
    return false;
  }
}

ReceivedSampleType::Handle ReceivedSampleType::handle_of(const Payload& payload) {
  CdrReader in(payload.data, payload.length);
  const std::string_view bus = in.text(), device = in.text(), channel = in.text();
  const auto hash = [&] { return hash_of(bus, device, channel); };
  if (!in.is_native()) return hash();
  const std::string_view whole(reinterpret_cast<const char*>(payload.data), in.size());
  return cache_.handle_of(whole.substr(kEncapsulationBytes), hash);
}

ReceivedSampleType::Handle ReceivedSampleType::hash_of(std::string_view bus,
                                                       std::string_view device,
                                                       std::string_view channel) {
  idl::Sample sample;
  sample.bus() = std::string(bus);
  sample.device() = std::string(device);
  sample.channel() = std::string(channel);
  Handle handle;
  Base::key_of(&sample, handle, false);
  return handle;
}

}  // namespace fieldcast
