#include "core/protocol/mitsubishi_mc_serial/frame.hpp"

#include <algorithm>
#include <array>

#include "core/codec/checksum.hpp"
#include "core/codec/digits.hpp"
#include "core/protocol/mitsubishi_mc/frame.hpp"
#include "core/protocol/received.hpp"

namespace fieldcast::mitsubishi_mc {
namespace {

constexpr std::array<std::uint8_t, 2> kLineEnd{'\r', '\n'};
constexpr std::array<std::uint8_t, 2> kBinaryBegin{kDle, kStx}, kBinaryEnd{kDle, kEtx};
constexpr std::size_t kResponseMark = 2;

void append_stuffed(Bytes& out, ByteView text) {
  for (const std::uint8_t byte : text) {
    out.push_back(byte);
    if (byte == kDle) out.push_back(kDle);
  }
}

bool is_start(std::uint8_t c) { return c == kStx || c == kAck || c == kNak; }

bool ends_line(ByteView text, std::size_t at) {
  return std::ranges::equal(text.subspan(at, kLineEnd.size()), kLineEnd);
}

// One frame in ASCII code.
class AsciiFrame {
 public:
  // `text`: from its first mark to the next one, or to the end of the received characters (`open`).
  AsciiFrame(ByteView text, bool open, const SerialFormat& format)
      : text_(text), open_(open), format_(format) {}

  SerialResponse parse() const { return text_[0] == kStx ? between_marks() : short_frame(); }

 private:
  using Kind = SerialResponse::Kind;

  SerialResponse incomplete() const { return {.kind = open_ ? Kind::kOpen : Kind::kBroken}; }

  SerialResponse between_marks() const {
    const auto etx = static_cast<std::size_t>(std::ranges::find(text_, kEtx) - text_.begin());
    if (etx == text_.size()) return incomplete();
    const std::size_t begin = 1 + header_size(format_) + format_.end_code_size();
    const Kind kind = etx < begin ? Kind::kBroken : kind_of(begin, etx);
    if (kind == Kind::kBroken) return {.kind = kind};
    const std::size_t end = etx + 1, sum = kind == Kind::kData ? format_.sum_size() : 0;
    if (text_.size() < end + sum) return incomplete();
    if (sum > 0 && read_digits(text_.subspan(end, sum)) != sum8(text_.subspan(1, etx)))
      return {.kind = Kind::kBroken};
    return whole(kind, begin, etx, end + sum);
  }

  SerialResponse short_frame() const {
    if (format_.enclosed) return {.kind = Kind::kBroken};
    const bool refused = text_[0] == kNak;
    const std::size_t begin = 1 + header_size(format_);
    const std::size_t end = begin + (refused ? format_.code_size() : 0);
    return whole(refused ? Kind::kRefused : Kind::kDone, begin, end, end);
  }

  // REQUIRES: begin <= etx. The end code of format 3 ends at `begin`.
  Kind kind_of(std::size_t begin, std::size_t etx) const {
    if (!format_.enclosed) return Kind::kData;
    const std::size_t size = format_.end_code_size();
    const std::string_view code(reinterpret_cast<const char*>(&text_[begin - size]), size);
    const EndCodePair codes = end_codes_of(format_.frame);
    if (code == codes.refused) return Kind::kRefused;
    if (code != codes.done) return Kind::kBroken;
    return etx > begin ? Kind::kData : Kind::kDone;
  }

  // `begin`, `end`: of the data, or of the code of a refusal; `size`: without CR LF. Only noise of
  // the line may follow a frame without a sum.
  SerialResponse whole(Kind kind, std::size_t begin, std::size_t end, std::size_t size) const {
    size += format_.end_size();
    if (text_.size() < size) return incomplete();
    SerialResponse response{.kind = Kind::kBroken};
    if (format_.line_end && !ends_line(text_, size - kLineEnd.size())) return response;
    if (kind != Kind::kData && !std::ranges::all_of(text_.subspan(size), is_turnaround))
      return response;
    const ByteView header = text_.subspan(1, header_size(format_));
    const ByteView body = text_.subspan(begin, end - begin);
    if (kind == Kind::kRefused) {
      const auto code = body.size() == format_.code_size() ? read_digits(body) : std::nullopt;
      if (!code) return response;
      response.code = static_cast<std::uint16_t>(*code);
    } else {
      response.data.assign(body.begin(), body.end());
    }
    response.header.assign(header.begin(), header.end());
    response.kind = kind;
    return response;
  }

  const ByteView text_;
  const bool open_;
  const SerialFormat& format_;
};

SerialResponse first_ascii(ByteView all, const SerialFormat& format) {
  const auto start = std::ranges::find_if(all, is_start);
  if (start == all.end()) return {};
  const auto next = std::find_if(start + 1, all.end(), is_start);
  SerialResponse response = AsciiFrame({start, next}, next == all.end(), format).parse();
  response.end = static_cast<std::size_t>(
      (response.kind == SerialResponse::Kind::kOpen ? start : next) - all.begin());
  return response;
}

// `text`: from the count on.
void read_binary(SerialResponse& response, ByteView text, const SerialFormat& format) {
  const std::size_t header = header_size(format);
  response.kind = SerialResponse::Kind::kBroken;
  if (text.size() < kCount + header + kResponseMark + kEndCode) return;
  if (read_number(text, {}, kCount) != text.size() - kCount) return;
  const ByteView rest = text.subspan(kCount + header);
  if (read_number(rest, {}, kResponseMark) != 0xFFFF) return;
  const auto begin = text.begin() + kCount;
  response.header.assign(begin, begin + static_cast<std::ptrdiff_t>(header));
  response.code =
      static_cast<std::uint16_t>(*read_number(rest.subspan(kResponseMark), {}, kEndCode));
  const ByteView data = rest.subspan(kResponseMark + kEndCode);
  response.data.assign(data.begin(), data.end());
  response.kind = response.code != 0 ? SerialResponse::Kind::kRefused
                  : data.empty()     ? SerialResponse::Kind::kDone
                                     : SerialResponse::Kind::kData;
}

SerialResponse first_binary(ByteView all, const SerialFormat& format) {
  const auto start = std::search(all.begin(), all.end(), kBinaryBegin.begin(), kBinaryBegin.end());
  if (start == all.end()) return {};
  const auto at = static_cast<std::size_t>(start - all.begin());
  const ByteView bytes = all.subspan(at);
  const Unstuffed frame = unstuffed(bytes);
  const std::size_t size = frame.size + format.sum_size();
  if (frame.kind == Unstuffed::Kind::kOpen ||
      (frame.kind == Unstuffed::Kind::kWhole && bytes.size() < size))
    return {.kind = SerialResponse::Kind::kOpen, .end = at};
  SerialResponse response{.kind = SerialResponse::Kind::kBroken, .end = at + frame.size};
  if (frame.kind == Unstuffed::Kind::kBroken) return response;
  if (format.sum_check && read_digits(bytes.subspan(frame.size, 2)) != sum8(frame.text))
    return response;
  read_binary(response, frame.text, format);
  if (response.kind != SerialResponse::Kind::kBroken) response.end = at + size;
  return response;
}

}  // namespace

Bytes header_of(const SerialFormat& format, const SerialRoute& route, std::uint8_t block) {
  const Format code{.ascii = !format.binary};
  const bool is_4c = format.frame == SerialFrame::k4c, is_1c = format.frame == SerialFrame::k1c;
  Bytes header;
  if (format.numbered) append_digits(header, block, kBlockDigits);
  if (!is_1c) append_number(header, code, is_4c ? 0xF8 : 0xF9, 1);
  append_number(header, code, route.station, 1);
  if (!is_1c) append_number(header, code, route.network, 1);
  append_number(header, code, route.pc, 1);
  if (is_4c) {
    append_number(header, code, route.module, 2);
    append_number(header, code, route.unit, 1);
  }
  if (!is_1c) append_number(header, code, route.own_station, 1);
  return header;
}

void append_request(Bytes& out, const SerialFormat& format, ByteView header, ByteView content) {
  Bytes text;
  if (format.binary)
    append_number(text, {}, static_cast<std::uint32_t>(header.size() + content.size()), kCount);
  append(text, header);
  append(text, content);
  if (format.binary) {
    append(out, kBinaryBegin);
    append_stuffed(out, text);
    append(out, kBinaryEnd);
  } else {
    if (format.enclosed) text.push_back(kEtx);
    out.push_back(format.enclosed ? kStx : kEnq);
    append(out, text);
  }
  if (format.sum_check) append_digits(out, sum8(text), 2);
  if (format.line_end) append(out, kLineEnd);
}

std::size_t request_size(const SerialFormat& format, std::size_t content) {
  const std::size_t marks = format.binary     ? kBinaryBegin.size() + kCount + kBinaryEnd.size()
                            : format.enclosed ? 2
                                              : 1;
  return marks + header_size(format) + content + format.sum_size() + format.end_size();
}

std::size_t response_size(const SerialFormat& format, std::size_t data) {
  if (format.binary) return request_size(format, kResponseMark + kEndCode + data);
  const std::size_t etx = data > 0 || format.enclosed ? 1 : 0;
  return 1 + header_size(format) + format.end_code_size() + data + etx +
         (data > 0 ? format.sum_size() : 0) + format.end_size();
}

Unstuffed unstuffed(ByteView bytes) {
  Unstuffed frame{.size = kBinaryBegin.size()};
  for (; frame.size < bytes.size(); ++frame.size) {
    const std::uint8_t byte = bytes[frame.size];
    if (byte == kDle) {
      if (frame.size + 1 == bytes.size()) return frame;
      const std::uint8_t next = bytes[frame.size + 1];
      if (next != kDle) {
        frame.kind = next == kEtx ? Unstuffed::Kind::kWhole : Unstuffed::Kind::kBroken;
        if (next == kEtx) frame.size += kBinaryEnd.size();
        return frame;
      }
      ++frame.size;
    }
    frame.text.push_back(byte);
  }
  return frame;
}

SerialResponse first_response(ByteView all, const SerialFormat& format) {
  return format.binary ? first_binary(all, format) : first_ascii(all, format);
}

}  // namespace fieldcast::mitsubishi_mc
