// `:` begins a frame at any time; characters between frames are ignored (Modbus over Serial Line
// V1.02, 2.5.2).
#include <algorithm>

#include "core/codec/checksum.hpp"
#include "core/protocol/modbus/framing.hpp"
#include "core/protocol/received.hpp"

namespace fieldcast::modbus {
namespace {

constexpr std::size_t kMarks = 3;        // `:` CR LF
constexpr std::size_t kMaxDigits = 510;  // unit, 253 bytes, LRC
constexpr std::uint8_t kColon = ':';
constexpr std::uint8_t kCr = '\r';
constexpr std::uint8_t kLf = '\n';

std::size_t ascii_size(std::size_t pdu_size) { return kMarks + 2 * (pdu_size + 2); }

void append_hex(Bytes& out, std::uint8_t byte) {
  static constexpr char kDigits[] = "0123456789ABCDEF";
  out.push_back(static_cast<std::uint8_t>(kDigits[byte >> 4]));
  out.push_back(static_cast<std::uint8_t>(kDigits[byte & 15]));
}

void wrap_ascii(const Header& header, ByteView pdu, Bytes& out) {
  out.push_back(kColon);
  append_hex(out, header.unit);
  for (const std::uint8_t byte : pdu) append_hex(out, byte);
  append_hex(out, static_cast<std::uint8_t>(lrc8(pdu) - header.unit));
  out.push_back(kCr);
  out.push_back(kLf);
}

// Without an odd last digit. Empty if a character is not a digit.
std::optional<ByteView> spelt(ByteView digits, Scratch& scratch) {
  const std::size_t count = std::min(digits.size() / 2, scratch.size());
  for (std::size_t i = 0; i < count; ++i) {
    const int high = ascii_digit(digits[2 * i]);
    const int low = ascii_digit(digits[2 * i + 1]);
    if (high < 0 || low < 0) return std::nullopt;
    scratch[i] = static_cast<std::uint8_t>(high << 4 | low);
  }
  return ByteView(scratch).first(count);
}

class AsciiSearch {
 public:
  AsciiSearch(ByteView all, const Header& header, const RequestPdu& request, Scratch& scratch)
      : all_(all), unit_(header.unit), request_(request), scratch_(scratch) {}

  ParseResult run() {
    auto colon = std::ranges::find(all_, kColon);
    noise_ = cause_of_noise({all_.begin(), colon}) != Cause::kNoResponse;
    while (colon != all_.end() && result_.pdu.empty()) {
      const auto next = std::find(colon + 1, all_.end(), kColon);
      examine({colon + 1, next}, next == all_.end());
      colon = next;
    }
    if (result_.pdu.empty()) result_.cause = cause();
    return result_;
  }

 private:
  // `text`: to the next colon, or to the end of the received bytes.
  void examine(ByteView text, bool open) {
    const auto cr = std::ranges::find(text, kCr);
    const ByteView digits(text.begin(), cr);
    const auto bytes = spelt(digits, scratch_);
    if (!bytes || digits.size() > kMaxDigits) return spoil();
    const auto behind = static_cast<std::size_t>(text.end() - cr);
    if (behind < 2) {
      if (open)
        begin(*bytes, text.size());
      else
        broken_ = true;
      return;
    }
    if (*(cr + 1) != kLf || digits.size() % 2 != 0 || bytes->size() < 3 || sum8(*bytes) != 0)
      return spoil();
    whole(*bytes);
  }

  void whole(ByteView frame) {
    const ByteView pdu = frame.subspan(1, frame.size() - 2);
    const Verdict verdict = frame[0] == unit_ ? request_.judge(pdu) : Verdict::kForeign;
    if (verdict == Verdict::kResponse || verdict == Verdict::kException) {
      result_.pdu = pdu;
      result_.kind = verdict == Verdict::kResponse ? ParseResult::Kind::kResponse
                                                   : ParseResult::Kind::kException;
      return;
    }
    (verdict == Verdict::kMismatch ? mismatch_ : foreign_) = true;
    // A valid frame ends the effect of earlier broken ones: the wait continues.
    result_.kind = ParseResult::Kind::kNothing;
    result_.missing = 0;
  }

  void begin(ByteView bytes, std::size_t received) {
    const bool exception = bytes.size() > 1 && (bytes[1] & kExceptionFlag) != 0;
    // Characters after the colon.
    const std::size_t length = ascii_size(exception ? 2 : request_.response_size()) - 1;
    result_.kind = ParseResult::Kind::kBegun;
    result_.missing = static_cast<std::uint32_t>(received < length ? length - received : 1);
    truncated_ = true;
  }

  void spoil() {
    broken_ = true;
    result_.kind = ParseResult::Kind::kBegun;
    result_.missing = 0;
  }

  Cause cause() const {
    if (mismatch_) return Cause::kMalformed;
    if (truncated_) return Cause::kTruncated;
    if (broken_) return Cause::kChecksum;
    if (foreign_) return Cause::kForeign;
    return noise_ ? Cause::kMalformed : Cause::kNoResponse;
  }

  const ByteView all_;
  const std::uint8_t unit_;
  const RequestPdu& request_;
  Scratch& scratch_;
  ParseResult result_;
  bool truncated_ = false, mismatch_ = false, foreign_ = false, broken_ = false, noise_ = false;
};

ParseResult find_in_ascii(ByteView all, const Header& header, const RequestPdu& request,
                          Scratch& scratch) {
  return AsciiSearch(all, header, request, scratch).run();
}

}  // namespace

const Framing& ascii_framing() {
  static constexpr Framing framing{ascii_size, wrap_ascii, find_in_ascii};
  return framing;
}

}  // namespace fieldcast::modbus
