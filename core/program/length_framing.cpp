#include "core/program/length_framing.hpp"

#include <algorithm>
#include <utility>

namespace fieldcast::program {
namespace {

constexpr std::uint32_t kStopLength = 0xFFFF'FFFF, kSettingsLength = 0xFFFF'FFFE;
constexpr std::size_t kHead = 4, kSettings = 7;

// 4 baud, stop, data, parity.
LengthFrame settings_from(ByteView body) {
  LineSettings settings;
  settings.baud = read_u32(body);
  settings.stop_bits = body[4];
  settings.data_bits = body[5];
  settings.parity = static_cast<Parity>(body[6]);
  const bool stop = settings.stop_bits == 1 || settings.stop_bits == 2;
  const bool data = settings.data_bits == 0 || settings.data_bits == 7 || settings.data_bits == 8;
  if (!stop || !data || settings.parity > Parity::kOdd) return FrameFault::kBadLine;
  return settings;
}

}  // namespace

std::optional<LengthFrame> LengthReader::next(ByteView& in) {
  if (left_ > 0) {
    if (in.empty()) return std::nullopt;
    const std::size_t count = std::min<std::size_t>(left_, in.size());
    const ByteView part = in.first(count);
    in = in.subspan(count);
    left_ -= static_cast<std::uint32_t>(count);
    return ChunkBytes{part};
  }
  while (true) {
    const bool settings = head_.size() >= kHead && read_u32(head_) == kSettingsLength;
    const std::size_t wanted = kHead + (settings ? kSettings : 0);
    if (head_.size() == wanted) break;
    if (in.empty()) return std::nullopt;
    const std::size_t count = std::min(wanted - head_.size(), in.size());
    append(head_, in.first(count));
    in = in.subspan(count);
    if (head_.size() == kHead && read_u32(head_) != kSettingsLength) break;
  }
  const Bytes head = std::exchange(head_, {});
  const std::uint32_t length = read_u32(head);
  if (length == 0) return Heartbeat{};
  if (length == kStopLength) return Stop{};
  if (length == kSettingsLength) return settings_from(ByteView(head).subspan(kHead));
  if (length > kMaxChunk) return FrameFault::kBadLength;
  left_ = length;
  return next(in);
}

void append_chunks(Bytes& out, ByteView bytes) {
  while (!bytes.empty()) {
    const std::size_t count = std::min<std::size_t>(bytes.size(), kMaxChunk);
    append_u32(out, static_cast<std::uint32_t>(count));
    append(out, bytes.first(count));
    bytes = bytes.subspan(count);
  }
}

void append_heartbeat(Bytes& out) { append_u32(out, 0); }
void append_stop(Bytes& out) { append_u32(out, kStopLength); }

void append_settings(Bytes& out, const LineSettings& settings) {
  append_u32(out, kSettingsLength);
  append_u32(out, settings.baud);
  out.push_back(settings.stop_bits);
  out.push_back(settings.data_bits);
  out.push_back(static_cast<std::uint8_t>(settings.parity));
}

}  // namespace fieldcast::program
