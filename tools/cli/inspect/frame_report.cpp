#include "tools/cli/inspect/frame_report.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <ostream>

#include "core/base/json.hpp"
#include "core/protocol/families/registry.hpp"
#include "tools/cli/model/sample_text.hpp"
#include "tools/cli/view/inspect_view.hpp"

namespace fieldcast::cli {
namespace {

constexpr std::size_t kBytesInLine = 64;

std::string_view mark_of(const SeenFrame& frame) {
  if (!frame.direction) return "..";
  return *frame.direction == Direction::kSent ? ">>" : "<<";
}

std::string hex_of(const Bytes& bytes) {
  const std::string hex = to_hex(ByteView(bytes).first(std::min(bytes.size(), kBytesInLine)));
  return bytes.size() > kBytesInLine ? fmt::format("{} .. {} bytes", hex, bytes.size()) : hex;
}

const BusSpec* bus_of(const BridgeSpec& spec, const std::string& name) {
  if (name.empty() && spec.buses.size() == 1) return &spec.buses.front();
  const auto found = std::ranges::find(spec.buses, name, &BusSpec::name);
  return found == spec.buses.end() ? nullptr : &*found;
}

}  // namespace

FrameReport::FrameReport(Options options, std::ostream& out, const Screen& screen)
    : options_(std::move(options)), out_(out), screen_(screen) {}

ValueDecoder* FrameReport::decoder_of(const std::string& bus) {
  if (options_.spec == nullptr) return nullptr;
  const auto known = decoders_.find(bus);
  if (known != decoders_.end()) return known->second.get();
  const BusSpec* spec = bus_of(*options_.spec, bus);
  if (spec == nullptr) return nullptr;
  return decoders_.emplace(bus, std::make_unique<ValueDecoder>(*spec)).first->second.get();
}

FrameReport::Explained FrameReport::explain(const SeenFrame& frame,
                                            const ValueDecoder* decoder) const {
  const DeviceSpec* device = decoder == nullptr ? nullptr : &decoder->asked_device();
  const bool declared = device != nullptr && device->declaration &&
                        (frame.protocol.empty() || frame.protocol == device->protocol);
  if (declared)
    return {device->protocol, declared::explain(*device->declaration.value, frame.bytes)};
  const std::string& name =
      frame.protocol.empty() && device != nullptr ? device->protocol : frame.protocol;
  if (const ProtocolEntry* entry = find_protocol(name)) return {name, entry->explain(frame.bytes)};
  if (!options_.protocol) return {name, {}};
  const NamedProtocol& given = *options_.protocol;
  return {std::string(given.name()),
          given.built_in != nullptr ? given.built_in->explain(frame.bytes)
                                    : declared::explain(*given.declaration.value, frame.bytes)};
}

void FrameReport::show(const SeenFrame& frame) {
  ValueDecoder* decoder = decoder_of(frame.bus);
  std::vector<DecodedValue> values;
  if (decoder != nullptr && frame.direction)
    values = decoder->take(*frame.direction, frame.bytes, frame.comment);
  const Explained explained = explain(frame, decoder);
  ++frames_;
  if (explained.fields.empty()) ++unknown_;
  if (count_faults(explained.fields) > 0) ++faulty_;
  options_.json ? show_json(frame, explained, values) : show_lines(frame, explained, values);
}

void FrameReport::remark(const std::string& time, const std::string& bus, const std::string& text) {
  if (!options_.json) out_ << printable(fmt::format("{} {} -- {}", time, bus, text)) << '\n';
}

void FrameReport::show_lines(const SeenFrame& frame, const Explained& explained,
                             const std::vector<DecodedValue>& values) {
  std::string head;
  for (const std::string& word : {frame.time, frame.bus, std::string(mark_of(frame)),
                                  explained.protocol, hex_of(frame.bytes)}) {
    if (!word.empty()) head += (head.empty() ? "" : " ") + word;
  }
  out_ << painted(printable(head), Tone::kTitle, screen_.colour) << '\n';
  for (std::size_t at = 0; at < frame.comment.size();) {
    const auto end = std::min(frame.comment.find('\n', at), frame.comment.size());
    out_ << "  # " << printable(frame.comment.substr(at, end - at)) << '\n';
    at = end + 1;
  }
  if (options_.fields) {
    for (const auto& line :
         inspect_lines(printable(explained.protocol), frame.bytes, explained.fields, screen_))
      out_ << "  " << line << '\n';
  } else {
    for (const FrameField& field : explained.fields) {
      if (!field.fault.empty())
        out_ << painted(
                    printable(fmt::format("  !! {} {}: {}", field.name, field.value, field.fault)),
                    Tone::kBad, screen_.colour)
             << '\n';
    }
  }
  for (const DecodedValue& value : values)
    out_ << printable(fmt::format("  {}/{} = {}{}{}", value.device, value.channel,
                                  value_text(value.value, value.type),
                                  value.unit.empty() ? "" : " ", value.unit))
         << '\n';
}

void FrameReport::show_json(const SeenFrame& frame, const Explained& explained,
                            const std::vector<DecodedValue>& values) {
  Json json = inspect_json(explained.protocol, frame.bytes, explained.fields);
  json.add("time", frame.time);
  json.add("bus", frame.bus);
  json.add("direction", !frame.direction                       ? ""
                        : *frame.direction == Direction::kSent ? "sent"
                                                               : "received");
  json.add("comment", frame.comment);
  Json list = Json::array();
  for (const DecodedValue& value : values)
    list.push_back({{"device", value.device},
                    {"channel", value.channel},
                    {"value", value.value},
                    {"unit", value.unit}});
  json.add("values", list);
  out_ << json.text() << '\n';
}

}  // namespace fieldcast::cli
