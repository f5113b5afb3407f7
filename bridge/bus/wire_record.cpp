#include "bridge/bus/wire_record.hpp"

#include <fmt/format.h>

#include "bridge/log/log.hpp"
#include "core/bus/bus_engine.hpp"

namespace fieldcast {

// The bytes of one frame arrive in pieces that follow each other within less.
constexpr std::int64_t kPiecesWithin = 250'000'000;  // ns

void WireRecord::sent(ByteView bytes, const BusEngine& engine, UtcTime at) {
  unseen_.reset();
  if (trace_) trace_line(at, bus_, TraceMark::kSent, to_hex(bytes));
  if (capturing())
    tap_->put({CaptureRecord::Kind::kSent, at, engine.asked_device(bytes).value_or(0),
               Bytes(bytes.begin(), bytes.end()), engine.request_text(bytes)});
}

bool WireRecord::unseen_frame_continues(UtcTime at) {
  if (capturing() && (!unseen_ || at.nanoseconds - unseen_->nanoseconds > kPiecesWithin)) {
    unseen_.reset();
    return false;
  }
  unseen_ = at;
  return true;
}

void WireRecord::received(ByteView bytes, UtcTime at) {
  if (trace_) trace_line(at, bus_, TraceMark::kReceived, to_hex(bytes));
  if (!unseen_frame_continues(at))
    tap_->put({CaptureRecord::Kind::kReceived, at, 0, Bytes(bytes.begin(), bytes.end())});
}

void WireRecord::frame_ended(UtcTime at) {
  if (!std::exchange(unseen_, std::nullopt) && capturing())
    tap_->put({CaptureRecord::Kind::kEnded, at});
}

void WireRecord::traced(const Traced& traced, UtcTime at) const {
  const std::string text = fmt::format("{}: {}", traced.device, traced.text);
  if (!unseen_) remark(text, at);
  if (trace_) trace_line(at, bus_, TraceMark::kRemark, text);
}

void WireRecord::remark(const std::string& text, UtcTime at) const {
  if (capturing()) tap_->put({CaptureRecord::Kind::kRemark, at, 0, {}, text});
}

}  // namespace fieldcast
