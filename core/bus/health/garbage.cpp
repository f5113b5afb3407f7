#include "core/bus/health/garbage.hpp"

#include <algorithm>
#include <bit>

#include "core/model/spec.hpp"

namespace fieldcast {
namespace {

std::size_t count_of(ByteView bytes, std::uint8_t wanted) {
  return static_cast<std::size_t>(std::count(bytes.begin(), bytes.end(), wanted));
}

bool is_text(std::uint8_t byte) {
  return (byte >= 0x20 && byte < 0x7F) || byte == '\r' || byte == '\n' || (byte >= 2 && byte <= 6);
}

// Seven data bits with a parity bit, read as eight bits: text whose highest bit is the parity.
bool is_text_with_parity(ByteView bytes, int odd) {
  return std::all_of(bytes.begin(), bytes.end(),
                     [&](std::uint8_t byte) {
                       return std::popcount(byte) % 2 == odd && is_text(byte & 0x7F);
                     }) &&
         std::any_of(bytes.begin(), bytes.end(), [](std::uint8_t byte) { return byte > 0x7F; });
}

// A sender at half the receiver's baud rate or slower never holds a level for a single bit of the
// receiver, from the start bit (0) over the data, lowest bit first, to the stop bit (1). In random
// characters half of the levels last a single bit. The stop bit may cut off the last level.
bool is_slow_sender(ByteView bytes) {
  int levels = 0, single = 0;
  for (const std::uint8_t byte : bytes) {
    const unsigned bits = 0x200u | static_cast<unsigned>(byte) << 1;
    for (int i = 1, length = 1; i < 9; ++i, ++length) {
      if ((bits >> i & 1u) == (bits >> (i - 1) & 1u)) continue;
      ++levels;
      single += length == 1 ? 1 : 0;
      length = 0;
    }
  }
  return single * 8 < levels;
}

std::string format_with(const LineFormat& line, Parity parity, std::uint8_t data_bits) {
  LineFormat other = line;
  other.parity = parity;
  other.data_bits = data_bits;
  const std::string text = to_text(other);
  return text.substr(text.rfind(' ') + 1);
}

}  // namespace

std::string looks_like(ByteView bytes, const LineFormat& line, bool over_network) {
  const std::string where = over_network ? " (at the serial server)" : "";
  constexpr std::size_t kEnough = 6;  // fewer bytes can match by chance
  const bool enough = bytes.size() >= kEnough;
  const std::size_t zeros = count_of(bytes, 0x00), ones = count_of(bytes, 0xFF);
  // With parity enabled, the driver delivers a character with a wrong parity or stop bit as 00
  // (termios(3), INPCK): about half zeros for a wrong parity, nearly only zeros for a wrong baud
  // rate.
  const bool checked = line.parity != Parity::kNone;
  if (enough && checked && zeros * 4 >= bytes.size())
    return "00 stands for a character with a wrong parity or stop bit: the device sends another "
           "format than " +
           format_with(line, line.parity, line.data_bits) + ", or at another baud; try " +
           format_with(line, Parity::kNone, line.data_bits) + ", " +
           format_with(line, line.parity == Parity::kEven ? Parity::kOdd : Parity::kEven,
                       line.data_bits) +
           ", then another baud" + where;
  if (enough && zeros == bytes.size())
    return "nothing but zeros: a line held low, or a sender of a much lower baud rate; check A and "
           "B, the bias of the line, and try a lower baud" +
           where;
  if (enough && ones == bytes.size())
    return "nothing but FF: noise on a line without bias or with one end open, or a sender of a "
           "much higher baud rate; check the wiring, and try a higher baud" +
           where;
  if (enough && line.data_bits == 8 && line.parity == Parity::kNone) {
    for (const int odd : {0, 1}) {
      if (!is_text_with_parity(bytes, odd)) continue;
      return "text of 7 bits with " + std::string(odd ? "odd" : "even") + " parity; try format " +
             format_with(line, odd ? Parity::kOdd : Parity::kEven, 7) + where;
    }
  }
  if (enough && is_slow_sender(bytes))
    return "long runs of one level: the sender's baud rate is lower than " +
           std::to_string(line.baud) + "; try a lower baud" + where;
  if (enough && std::all_of(bytes.begin(), bytes.end(), is_text))
    return "text: a device that speaks another protocol, or a console; check the protocol and the "
           "device's mode";
  return "no frame of this protocol: try another baud, parity or number of stop bits" + where +
         ", and look for a second device with this address or another master";
}

ResponseShape response_shape(ByteView bytes, ByteView request, std::size_t expected) {
  constexpr std::size_t kHead = 2;
  if (expected == 0 || bytes.size() < kHead || request.size() < kHead ||
      !std::equal(bytes.begin(), bytes.begin() + kHead, request.begin()))
    return ResponseShape::kOther;
  const bool echo = bytes.size() >= request.size()
                        ? std::equal(request.begin(), request.end(), bytes.begin())
                        : std::equal(bytes.begin(), bytes.end(), request.begin());
  if (echo) return ResponseShape::kOther;
  if (bytes.size() == expected) return ResponseShape::kWhole;
  return bytes.size() < expected ? ResponseShape::kCut : ResponseShape::kLong;
}

std::string_view broken_response_text(ResponseShape shape) {
  switch (shape) {
    case ResponseShape::kWhole:
      return "they begin like its response and have the right length, but a wrong checksum, so "
             "baud "
             "and format are probably right: two devices have this address, or the line is "
             "disturbed. Connect one device alone, then check termination and shield";
    case ResponseShape::kLong:
      return "they begin like its response and continue beyond its length, so baud and "
             "format are probably right: two devices with this address respond, or another master "
             "asks it. Connect one device alone, and give each an address of its own";
    case ResponseShape::kCut:
      return "they begin like its response, and the end is missing, so baud and format are "
             "probably right: an adapter or a gateway cuts the response, it pauses for longer than "
             "gap-allowance, or two devices have this address. Try a greater gap-allowance and a "
             "smaller max-block, then another adapter";
    case ResponseShape::kOther: break;
  }
  return {};
}

bool Garbage::received(ByteView bytes, ByteView request, std::size_t expected) {
  if (bytes.empty()) return false;
  ++exchanges_;
  ++shapes_[static_cast<std::size_t>(response_shape(bytes, request, expected))];
  bytes_ += bytes.size();
  echo_ = echo_ && bytes.size() <= request.size() &&
          std::equal(bytes.begin(), bytes.end(), request.begin());
  append(last_, bytes.last(std::min(bytes.size(), kKept)));
  if (last_.size() > kKept)
    last_.erase(last_.begin(), last_.end() - static_cast<std::ptrdiff_t>(kKept));
  return exchanges_ >= kWorthSaying;
}

ResponseShape Garbage::shape() const {
  if (shapes_[0] * 2 >= exchanges_) return ResponseShape::kOther;
  const auto most = std::max_element(shapes_.begin() + 1, shapes_.end());
  return static_cast<ResponseShape>(most - shapes_.begin());
}

bool Garbage::responded() {
  const bool said = exchanges_ >= kWorthSaying;
  if (exchanges_ != 0) *this = {};
  return said;
}

std::string Garbage::text(const LineFormat* line, bool over_network) const {
  const ByteView all = last_;
  const ResponseShape broken = shape();
  std::string diagnosis;
  if (line == nullptr)
    diagnosis =
        "the device or its gateway sends a response with another structure, as `fieldcast inspect` "
        "shows; check that the protocol and the unit are the right ones";
  else if (echo_)
    diagnosis =
        "what was sent comes back, and nothing else: an adapter that gives back what it sends, and "
        "a device that does not respond; check the device and its address";
  else if (broken != ResponseShape::kOther)
    diagnosis = broken_response_text(broken);
  else
    diagnosis = looks_like(all, *line, over_network);
  return "bytes arrive that are not a response: " + std::to_string(bytes_) + " in " +
         std::to_string(exchanges_) + " exchanges, the last ones " +
         to_hex(all.last(std::min(all.size(), kShown))) + ": " + diagnosis;
}

}  // namespace fieldcast
