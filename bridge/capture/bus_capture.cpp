#include "bridge/capture/bus_capture.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "core/capture/pcapng.hpp"
#include "core/model/port_spec.hpp"
#include "core/protocol/families/registry.hpp"

namespace fieldcast {

namespace {

constexpr std::string_view kApplication = "Fieldcast";
constexpr std::string_view kDeclared = "fieldcast-frame";  // tools/wireshark/fieldcast.lua

std::string about(const BusSpec& bus, const std::string& by) {
  std::string protocols;
  for (const DeviceSpec& device : bus.devices) {
    if (protocols.find(device.protocol) != protocols.npos) continue;
    protocols += (protocols.empty() ? "" : ", ") + device.protocol;
  }
  return fmt::format("bus {} of {}, {}, {}", bus.name, by, name_of(bus.port), protocols);
}

}  // namespace

BusCapture::BusCapture(const BusSpec& bus, const std::string& by, std::shared_ptr<CaptureTap> tap)
    : bus_(bus.name), about_(about(bus, by)), tap_(std::move(tap)) {
  for (const DeviceSpec& device : bus.devices) {
    const ProtocolEntry* entry =
        device.declaration ? nullptr : find_protocol(std::string_view(device.protocol));
    Dissector made;
    if (entry == nullptr) {
      made = {std::string(kDeclared), device.protocol};
    } else if (entry->dissector.empty()) {
      made = {fmt::format("fieldcast-{}", entry->name), std::string(entry->name)};
    } else {
      made = {std::string(entry->dissector), {}};
    }
    dissectors_.push_back(std::move(made));
  }
}

void BusCapture::add(CaptureSink& sink) {
  if (sinks_.empty()) (void)tap_->take();  // discards records of an earlier capture
  sinks_.push_back(&sink);
  tell_tap();
}

void BusCapture::remove(CaptureSink& sink) {
  std::erase(sinks_, &sink);
  tell_tap();
  if (sinks_.empty()) gatherer_ = {};
}

void BusCapture::tell_tap() {
  using Wanted = CaptureTap::Wanted;
  if (sinks_.empty()) return tap_->want(Wanted::kNothing);
  tap_->want(std::ranges::all_of(sinks_, &CaptureSink::only_sessions) ? Wanted::kSessions
                                                                      : Wanted::kEverything);
}

Bytes BusCapture::head(const std::string& remark) const {
  Bytes out;
  pcapng::append_section(out, kApplication, remark.empty() ? about_ : about_ + "; " + remark);
  pcapng::append_interface(out, bus_, about_);
  return out;
}

void BusCapture::drain(UtcTime now) {
  std::vector<CapturedFrame> frames;
  CaptureTap::Taken taken = tap_->take();
  for (CaptureRecord& record : taken.records) gatherer_.take(std::move(record), frames);
  if (taken.lost > 0) {
    gatherer_.lost(taken.lost, frames);
  } else {
    gatherer_.look(now, frames);
  }
  give(frames);
  if (taken.lost == 0) return;
  for (CaptureSink* sink : sinks_) sink->lost(taken.lost);
}

void BusCapture::finish(UtcTime now) {
  drain(now);
  std::vector<CapturedFrame> frames;
  gatherer_.flush(frames);
  give(frames);
}

void BusCapture::give(std::vector<CapturedFrame>& frames) {
  Bytes block;
  for (const CapturedFrame& frame : frames) {
    const Dissector& dissector = dissectors_[std::min(frame.device, dissectors_.size() - 1)];
    const Bytes data =
        make_upper_pdu(dissector.name, dissector.column, frame.direction, frame.bytes);
    block.clear();
    pcapng::append_packet(block, {frame.at, frame.direction, data, frame.comment});
    for (CaptureSink* sink : sinks_) sink->packet(block, frame.at, frame.session);
  }
}

Bytes capture_tail(const CaptureCounts& counts, const std::string& why) {
  Bytes out;
  std::string comment = why;
  if (counts.dropped > 0)
    comment += fmt::format("{}{} pieces are missing: the capture was too slow for them",
                           why.empty() ? "" : "; ", counts.dropped);
  pcapng::append_statistics(out,
                            {counts.begun, counts.ended, counts.frames, counts.dropped, comment});
  return out;
}

}  // namespace fieldcast
