// Frame boundaries are only certain at the start of the response and after a frame with a valid
// CRC; elsewhere the search advances byte by byte.
#include <algorithm>

#include "core/codec/checksum.hpp"
#include "core/protocol/modbus/framing.hpp"
#include "core/protocol/received.hpp"

namespace fieldcast::modbus {
namespace {

constexpr std::size_t kOverhead = 3;  // unit, CRC
constexpr std::uint8_t kHighestUnit = 247;
// This wait need not cover the whole rest of a frame, as each received byte restarts it.
constexpr std::size_t kDoubtfulWait = 8;

std::size_t rtu_size(std::size_t pdu_size) { return pdu_size + kOverhead; }

void wrap_rtu(const Header& header, ByteView pdu, Bytes& out) {
  const std::size_t start = out.size();
  out.push_back(header.unit);
  append(out, pdu);
  append_crc16(out, start);
}

class RtuSearch {
 public:
  RtuSearch(ByteView all, const Header& header, const RequestPdu& request)
      : all_(all),
        unit_(header.unit),
        request_(request),
        expected_(rtu_size(request.response_size())) {}

  ParseResult run() {
    while (at_ < all_.size() && result_.pdu.empty() && result_.fallback.empty()) examine();
    if (!result_.pdu.empty()) return result_;
    // As many broken bytes as a response has: a valid one follows immediately, or not at all.
    const bool spoilt = faults_.broken || faults_.noise >= expected_;
    if (begun_ || spoilt) result_.kind = ParseResult::Kind::kBegun;
    result_.cause = faults_.cause();
    return result_;
  }

 private:
  void examine() {
    const ByteView bytes = all_.subspan(at_);
    const bool mine = bytes[0] == unit_ &&
                      (bytes.size() == 1 || (bytes[1] & ~kExceptionFlag) == request_.function());
    const bool other = bytes[0] >= 1 && bytes[0] <= kHighestUnit && bytes.size() > 1;
    if (!mine && !other) return slide();
    const std::size_t length = length_of(bytes, mine);
    if (length == 0) return slide();
    if (bytes.size() >= length && ends_with_crc16(bytes.first(length)))
      return whole(bytes.first(length), mine);
    // A wrong byte count in an otherwise valid frame.
    if (mine && bytes.size() >= expected_ && ends_with_crc16(bytes.first(expected_)))
      return skip(expected_, faults_.mismatch);
    if (bytes.size() < length) {
      if (mine || at_boundary_) begin(bytes, length, mine);
    } else if (mine || at_boundary_) {
      faults_.broken = true;
    }
    slide();
  }

  // Length from the frame's fields, or as expected while they are missing. 0: not a frame.
  std::size_t length_of(ByteView bytes, bool mine) const {
    const bool exception = bytes.size() > 1 && (bytes[1] & kExceptionFlag) != 0;
    if (mine && bytes.size() < 3 && !exception) return expected_;
    const std::size_t pdu_size = response_pdu_size(bytes.subspan(1));
    const std::size_t length = rtu_size(pdu_size);
    return pdu_size == 0 || length > kMaxRtuFrame ? 0 : length;
  }

  void whole(ByteView frame, bool mine) {
    const ByteView pdu = frame.subspan(1, frame.size() - kOverhead);
    const Verdict verdict = mine ? request_.judge(pdu) : Verdict::kForeign;
    if (verdict == Verdict::kResponse || verdict == Verdict::kException) {
      if (open_at_boundary_) {
        result_.fallback = pdu;
      } else {
        result_.pdu = pdu;
        result_.kind = verdict == Verdict::kResponse ? ParseResult::Kind::kResponse
                                                     : ParseResult::Kind::kException;
      }
      return;
    }
    skip(frame.size(), verdict == Verdict::kMismatch ? faults_.mismatch : faults_.foreign);
  }

  void skip(std::size_t size, bool& seen) {
    seen = true;
    at_ += size;
    at_boundary_ = true;
  }

  // An incomplete frame. At a boundary it owns the following bytes until it is complete or silence
  // shows that it was noise; otherwise a response could be read from the middle of another's data.
  void begin(ByteView bytes, std::size_t length, bool mine) {
    const bool exception = bytes.size() > 1 && (bytes[1] & kExceptionFlag) != 0;
    const bool certain =
        mine && at_boundary_ && (length == expected_ || exception || request_.varies());
    const std::size_t missing = length - bytes.size();
    if (!begun_)
      result_.missing =
          static_cast<std::uint32_t>(certain ? missing : std::min(missing, kDoubtfulWait));
    begun_ = true;
    if (at_boundary_) open_at_boundary_ = true;
    if (!mine)
      faults_.foreign = true;
    else if (at_boundary_)
      faults_.truncated = true;
    else
      faults_.cut = true;
  }

  void slide() {
    if (!is_turnaround(all_[at_])) {
      at_boundary_ = false;
      ++faults_.noise;
    }
    ++at_;
  }

  const ByteView all_;
  const std::uint8_t unit_;
  const RequestPdu& request_;
  const std::size_t expected_;  // size of the expected frame
  ParseResult result_;
  std::size_t at_ = 0;
  bool at_boundary_ = true;
  bool begun_ = false;             // some frame is incomplete
  bool open_at_boundary_ = false;  // that frame began at a boundary
  SearchFaults faults_;
};

ParseResult find_in_rtu(ByteView all, const Header& header, const RequestPdu& request, Scratch&) {
  return RtuSearch(all, header, request).run();
}

}  // namespace

const Framing& rtu_framing() {
  static constexpr Framing framing{rtu_size, wrap_rtu, find_in_rtu};
  return framing;
}

}  // namespace fieldcast::modbus
