#include "tools/cli/inspect/capture_input.hpp"

#include <fmt/format.h>

#include <istream>
#include <map>
#include <ostream>

#include "core/base/message_text.hpp"
#include "core/capture/capture_record.hpp"
#include "core/capture/pcapng.hpp"
#include "core/capture/pcapng_reader.hpp"
#include "core/capture/trace_text.hpp"
#include "core/protocol/families/registry.hpp"
#include "tools/cli/model/sample_text.hpp"

namespace fieldcast::cli {
namespace {

constexpr std::string_view kOwn = "fieldcast-";
constexpr std::string_view kDeclaredFrames = "fieldcast-frame";

// Protocol of a dissector; an unknown dissector is returned unchanged.
std::string protocol_of(const UpperPdu& pdu) {
  for (const ProtocolEntry& entry : protocols()) {
    if (pdu.dissector == entry.dissector) return std::string(entry.name);
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
  for (std::size_t i = 0; i < 4; ++i) {
    const int c = in.get();
    if (c == std::istream::traits_type::eof()) break;
    first[i] = static_cast<std::uint8_t>(c);
  }
  in.clear();
  in.seekg(0);
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

ExitCode show_capture(std::istream& in, const std::string& name, FrameReport& report,
                      std::ostream& err) {
  pcapng::Reader reader([&](std::uint8_t* to, std::size_t size) {
    in.read(reinterpret_cast<char*>(to), static_cast<std::streamsize>(size));
    return static_cast<std::size_t>(in.gcount());
  });
  std::size_t others = 0;
  auto read = reader.next();
  for (; read && *read; read = reader.next()) {
    const pcapng::ReadPacket& packet = **read;
    const auto pdu = packet.interface.linktype == pcapng::kLinktypeUpperPdu
                         ? parse_upper_pdu(packet.data)
                         : std::nullopt;
    if (!pdu) {
      ++others;
      continue;
    }
    report.show({utc_text(packet.at), packet.interface.name, direction_of(packet, *pdu),
                 protocol_of(*pdu), Bytes(pdu->frame.begin(), pdu->frame.end()), packet.comment});
  }
  const std::string frames = counted(report.frames(), "frame", "frames");
  if (!read) {
    const bool none =
        read.error() == pcapng::Fault::kNoCapture || read.error() == pcapng::Fault::kOldFormat;
    err << fmt::format("fieldcast inspect: {} {}", printable(name), to_text(read.error()));
    if (!none) err << fmt::format(" at byte {}; {} before it", reader.offset(), frames);
    err << '\n';
    return none ? ExitCode::kUsage : ExitCode::kFound;
  }
  err << fmt::format("fieldcast inspect: {}, {} with a fault", frames, report.faulty());
  if (reader.dropped() > 0) err << fmt::format(", {} missing", reader.dropped());
  if (others > 0)
    err << fmt::format("; {} not from a bus", counted(others, "packet is", "packets are"));
  err << '\n';
  return report.faulty() > 0 ? ExitCode::kFound : ExitCode::kOk;
}

bool show_trace(std::string_view text, FrameReport& report) {
  bool any = false;
  // By bus: a response arrives in pieces and ends when another line follows.
  std::map<std::string, SeenFrame> answers;
  const auto end_answer = [&](const std::string& bus) {
    if (const auto answer = answers.extract(bus)) report.show(answer.mapped());
  };
  while (!text.empty()) {
    const auto end = text.find('\n');
    auto line = parse_trace_text(text.substr(0, end));
    text = end == text.npos ? std::string_view{} : text.substr(end + 1);
    if (!line) continue;
    any = true;
    const std::string time(line->time), bus(line->bus);
    if (line->mark == TraceText::Mark::kReceived) {
      if (answers[bus].bytes.size() + line->bytes.size() > FrameGatherer::kMaxFrame)
        end_answer(bus);
      SeenFrame& piece = answers[bus];
      piece.time = time;
      piece.bus = bus;
      piece.direction = Direction::kReceived;
      append(piece.bytes, line->bytes);
      continue;
    }
    end_answer(bus);
    if (line->mark == TraceText::Mark::kRemark)
      report.remark(time, bus, std::string(line->text));
    else
      report.show({time, bus, Direction::kSent, {}, std::move(line->bytes), {}});
  }
  while (!answers.empty()) end_answer(std::string(answers.begin()->first));
  return any;
}

}  // namespace fieldcast::cli
