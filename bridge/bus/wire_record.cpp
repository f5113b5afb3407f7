#include "bridge/bus/wire_record.hpp"

#include <fmt/format.h>

#include "bridge/log/log.hpp"
#include "core/bus/bus_engine.hpp"

namespace fieldcast {

void WireRecord::sent(ByteView bytes, const BusEngine& engine, UtcTime at) const {
  if (trace_) trace_line(at, bus_, TraceMark::kSent, to_hex(bytes));
  if (capturing())
    tap_->put({CaptureRecord::Kind::kSent, at, engine.asked_device(bytes).value_or(0),
               Bytes(bytes.begin(), bytes.end()), engine.request_text(bytes)});
}

void WireRecord::received(ByteView bytes, UtcTime at) const {
  if (trace_) trace_line(at, bus_, TraceMark::kReceived, to_hex(bytes));
  if (capturing())
    tap_->put({CaptureRecord::Kind::kReceived, at, 0, Bytes(bytes.begin(), bytes.end())});
}

void WireRecord::frame_ended(UtcTime at) const {
  if (capturing()) tap_->put({CaptureRecord::Kind::kEnded, at});
}

void WireRecord::traced(const Traced& traced, UtcTime at) const {
  const std::string text = fmt::format("{}: {}", traced.device, traced.text);
  remark(text, at);
  if (trace_) trace_line(at, bus_, TraceMark::kRemark, text);
}

void WireRecord::remark(const std::string& text, UtcTime at) const {
  if (capturing()) tap_->put({CaptureRecord::Kind::kRemark, at, 0, {}, text});
}

}  // namespace fieldcast
