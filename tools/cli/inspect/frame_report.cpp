#include "tools/cli/inspect/frame_report.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <istream>
#include <map>
#include <ostream>
#include <sstream>
#include <utility>

#include "core/base/json.hpp"
#include "core/base/message_text.hpp"
#include "core/capture/capture_record.hpp"
#include "core/capture/pcapng.hpp"
#include "core/capture/pcapng_reader.hpp"
#include "core/capture/trace_text.hpp"
#include "core/protocol/families/registry.hpp"
#include "tools/cli/model/sample_text.hpp"
#include "tools/cli/view/check_view.hpp"

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

// Built in, an installed declaration, or that of the command line. A capture cannot name a file.
const NamedProtocol* FrameReport::named_protocol_of(const std::string& name) {
  const auto [known, is_new] = protocols_.try_emplace(name);
  if (is_new && !name.empty() && name.find_first_of("/.") == std::string::npos) {
    std::ostringstream unknown;
    known->second = named_protocol(name, "inspect", unknown);
  }
  if (known->second) return &*known->second;
  return options_.protocol ? &*options_.protocol : nullptr;
}

FrameReport::FoundProtocol FrameReport::protocol_of(const SeenFrame& frame) {
  const ValueDecoder* decoder = decoder_of(frame.bus);
  const DeviceSpec* device = decoder == nullptr ? nullptr : &decoder->asked_device();
  const bool from_device =
      device != nullptr && (frame.protocol.empty() || frame.protocol == device->protocol);
  if (from_device && device->declaration)
    return {device->protocol, nullptr, device->declaration.value.get()};
  const std::string& name = from_device ? device->protocol : frame.protocol;
  const NamedProtocol* protocol = named_protocol_of(name);
  if (protocol == nullptr) return {name};
  return {std::string(protocol->name()), protocol->built_in, protocol->declaration.value.get()};
}

FrameReport::Explained FrameReport::explain(const SeenFrame& frame) {
  const auto sender = !frame.direction                       ? declared::Sender::kUnknown
                      : *frame.direction == Direction::kSent ? declared::Sender::kBridge
                                                             : declared::Sender::kDevice;
  const FoundProtocol protocol = protocol_of(frame);
  if (protocol.built_in != nullptr) return {protocol.name, protocol.built_in->explain(frame.bytes)};
  if (protocol.declaration == nullptr) return {protocol.name, {}};
  return {protocol.name, declared::explain(*protocol.declaration, frame.bytes, sender)};
}

namespace {

// Devices with addresses are left out: the search needs the address.
bool only_unsolicited(const declared::Declaration& declaration) {
  return declaration.lowest_address == declaration.highest_address &&
         std::ranges::all_of(declaration.operations, [](const declared::Operation& operation) {
           return operation.unsolicited > Duration::zero();
         });
}

}  // namespace

void FrameReport::show(const SeenFrame& frame) {
  const declared::Declaration* declaration = protocol_of(frame).declaration;
  if (declaration == nullptr || frame.direction != Direction::kReceived ||
      !only_unsolicited(*declaration))
    return show_whole(frame);
  SeenFrame& begun = begun_[frame.bus];
  Bytes bytes = std::move(begun.bytes);
  append(bytes, frame.bytes);
  begun = frame;
  for (std::size_t used = 1; used > 0 && !bytes.empty();) {
    used = declared::find_unsolicited(*declaration, declaration->lowest_address, bytes, true).used;
    begun.bytes.assign(bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(used));
    bytes.erase(bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(used));
    if (used > 0) show_whole(begun);
  }
  begun.bytes = std::move(bytes);
  if (begun.bytes.size() > declared::kMaxFrame) show_whole(std::exchange(begun, {}));
}

void FrameReport::finish() {
  for (const auto& [bus, frame] : std::exchange(begun_, {})) {
    if (!frame.bytes.empty()) show_whole(frame);
  }
}

void FrameReport::show_whole(const SeenFrame& frame) {
  ValueDecoder* decoder = decoder_of(frame.bus);
  std::vector<DecodedValue> values;
  if (decoder != nullptr && frame.direction)
    values = decoder->take(*frame.direction, frame.bytes, frame.comment);
  const Explained explained = explain(frame);
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
  if (explained.fields.empty()) {
    out_ << "  not explained: the protocol is unknown\n";
  } else if (options_.fields) {
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

namespace {

constexpr std::string_view kOwn = "fieldcast-";
constexpr std::string_view kDeclaredFrames = "fieldcast-frame";

// Protocol of a dissector; an unknown dissector is returned unchanged.
std::string protocol_of(const UpperPdu& pdu) {
  for (const ProtocolEntry& entry : protocols()) {
    if (!entry.dissector.empty() && pdu.dissector == entry.dissector)
      return std::string(entry.name);
  }
  if (pdu.dissector == kDeclaredFrames) return pdu.column;
  if (pdu.dissector.starts_with(kOwn)) return pdu.dissector.substr(kOwn.size());
  return pdu.dissector;
}

std::optional<Direction> direction_of(const pcapng::ReadPacket& packet, const UpperPdu& pdu) {
  if (packet.direction) return packet.direction;
  if (pdu.destination_port == kDevicePort) return Direction::kSent;
  if (pdu.source_port == kDevicePort) return Direction::kReceived;
  return std::nullopt;
}

}  // namespace

bool is_capture(std::istream& in) {
  std::uint8_t first[4] = {};
  std::size_t read = 0;
  for (; read < 4; ++read) {
    const int c = in.get();
    if (c == std::istream::traits_type::eof()) break;
    first[read] = static_cast<std::uint8_t>(c);
  }
  in.clear();
  for (; read > 0; --read) in.unget();  // a pipe has no position for seekg()
  const std::uint32_t magic = read_u32(first);
  const std::uint32_t swapped = static_cast<std::uint32_t>(first[3]) << 24 |
                                static_cast<std::uint32_t>(first[2]) << 16 | first[1] << 8 |
                                first[0];
  for (const std::uint32_t one : {magic, swapped}) {
    if (one == pcapng::kSectionHeader || one == pcapng::kOldPcapMagic ||
        one == pcapng::kOldPcapNanoMagic)
      return true;
  }
  return false;
}

bool has_name_of_capture(std::string_view path) {
  return path.ends_with(".pcapng") || path.ends_with(".pcap");
}

CaptureEnd read_capture(std::istream& in, const OnFrame& on_frame) {
  pcapng::Reader reader([&](std::uint8_t* to, std::size_t size) {
    in.read(reinterpret_cast<char*>(to), static_cast<std::streamsize>(size));
    return static_cast<std::size_t>(in.gcount());
  });
  CaptureEnd end;
  auto read = reader.next();
  for (; read && *read; read = reader.next()) {
    const pcapng::ReadPacket& packet = **read;
    const auto pdu = packet.interface.linktype == pcapng::kLinktypeUpperPdu
                         ? parse_upper_pdu(packet.data)
                         : std::nullopt;
    if (!pdu) {
      ++end.others;
      continue;
    }
    on_frame({utc_text(packet.at), packet.interface.name, direction_of(packet, *pdu),
              protocol_of(*pdu), Bytes(pdu->frame.begin(), pdu->frame.end()), packet.comment});
  }
  if (!read) end.fault = read.error();
  end.offset = reader.offset();
  end.dropped = reader.dropped();
  return end;
}

void explain_fault(const CaptureEnd& end, const std::string& name, std::size_t frames,
                   std::ostream& err) {
  err << fmt::format("fieldcast inspect: {} {}", printable(name), to_text(*end.fault));
  if (!end.is_no_capture())
    err << fmt::format(" at byte {}; {} before it", end.offset, counted(frames, "frame", "frames"));
  err << '\n';
}

ExitCode show_capture(std::istream& in, const std::string& name, FrameReport& report,
                      std::ostream& err) {
  const CaptureEnd end = read_capture(in, [&](const SeenFrame& frame) { report.show(frame); });
  report.finish();
  const std::string frames = counted(report.frames(), "frame", "frames");
  if (end.fault) {
    explain_fault(end, name, report.frames(), err);
    return end.is_no_capture() ? ExitCode::kUsage : ExitCode::kFound;
  }
  err << fmt::format("fieldcast inspect: {}, {} with a fault", frames, report.faulty());
  if (report.unknown() > 0)
    err << fmt::format(", {} of unknown protocols (add --config FILE)", report.unknown());
  if (end.dropped > 0) err << fmt::format(", {} missing", end.dropped);
  if (end.others > 0)
    err << fmt::format("; {} not from a bus", counted(end.others, "packet is", "packets are"));
  err << '\n';
  return report.faulty() > 0 ? ExitCode::kFound : ExitCode::kOk;
}

bool read_trace(std::string_view text, const OnFrame& on_frame, const OnRemark& on_remark) {
  bool any = false;
  // By bus: a response arrives in pieces and ends when another line follows.
  std::map<std::string, SeenFrame> responses;
  const auto end_response = [&](const std::string& bus) {
    if (const auto response = responses.extract(bus)) on_frame(response.mapped());
  };
  while (!text.empty()) {
    const auto end = text.find('\n');
    auto line = parse_trace_text(text.substr(0, end));
    text = end == text.npos ? std::string_view{} : text.substr(end + 1);
    if (!line) continue;
    any = true;
    const std::string time(line->time), bus(line->bus);
    if (line->mark == TraceText::Mark::kReceived) {
      if (responses[bus].bytes.size() + line->bytes.size() > FrameGatherer::kMaxFrame)
        end_response(bus);
      SeenFrame& piece = responses[bus];
      piece.time = time;
      piece.bus = bus;
      piece.direction = Direction::kReceived;
      append(piece.bytes, line->bytes);
      continue;
    }
    end_response(bus);
    if (line->mark == TraceText::Mark::kRemark)
      on_remark(time, bus, std::string(line->text));
    else
      on_frame({time, bus, Direction::kSent, {}, std::move(line->bytes), {}});
  }
  while (!responses.empty()) end_response(std::string(responses.begin()->first));
  return any;
}

bool show_trace(std::string_view text, FrameReport& report) {
  const bool any = read_trace(
      text, [&](const SeenFrame& frame) { report.show(frame); },
      [&](const auto&... words) { report.remark(words...); });
  report.finish();
  return any;
}

}  // namespace fieldcast::cli
