#include "core/base/message_text.hpp"
#include "schema/forward.pb.h"
#include "tools/forward/payload/codec.hpp"

namespace fieldcast::forward {

namespace {

// What a program wrote can contain any bytes; protobuf refuses a string that is not UTF-8.
std::string utf8_of(const std::string& text) { return is_utf8(text) ? text : escaped(text); }

}  // namespace

std::string encode(std::string_view site, const AuditReport& entry) {
  v1::Audit out;
  out.set_schema(kSchema);
  out.set_site(std::string(site));
  out.set_bridge(entry.bridge);
  out.set_epoch(entry.epoch);
  out.set_number(entry.number);
  out.set_at(entry.at.nanoseconds);
  out.set_who(utf8_of(entry.who));
  out.set_what(utf8_of(entry.what));
  out.set_target(utf8_of(entry.target));
  out.set_bytes_to_device(entry.bytes_to_device);
  out.set_bytes_from_device(entry.bytes_from_device);
  out.set_result(utf8_of(entry.result));
  return out.SerializeAsString();
}

std::optional<AuditReport> decode_audit(std::string_view text) {
  v1::Audit from;
  if (!from.ParseFromArray(text.data(), static_cast<int>(text.size())) || from.schema() != kSchema)
    return std::nullopt;
  AuditReport entry;
  entry.bridge = from.bridge();
  entry.epoch = from.epoch();
  entry.number = from.number();
  entry.at = {from.at()};
  entry.who = from.who();
  entry.what = from.what();
  entry.target = from.target();
  entry.bytes_to_device = from.bytes_to_device();
  entry.bytes_from_device = from.bytes_from_device();
  entry.result = from.result();
  return entry;
}

}  // namespace fieldcast::forward
