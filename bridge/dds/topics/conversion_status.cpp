#include <algorithm>

#include "bridge/dds/guard/rtps_message.hpp"
#include "bridge/dds/topics/conversion.hpp"

namespace fieldcast {

static_assert(static_cast<std::size_t>(Cause::kCount) + kRtpsFaults <= 64,
              "the IDL's sequence<CauseCount, 64>");

namespace {

constexpr std::size_t kMaxRefused = 64, kMaxRefusedText = 64, kMaxAreas = 32, kMaxAreaText = 32;

// Writes the counters; `first`, unless kNone, is written before the others.
void to_idl(const CauseCounters& counters, std::vector<idl::CauseCount>& out,
            Cause first = Cause::kNone) {
  out.clear();
  if (first != Cause::kNone) {
    out.emplace_back();
    out.back().cause() = std::string(to_name(first));
    out.back().count(counters[first]);
  }
  for (std::size_t i = 1; i < static_cast<std::size_t>(Cause::kCount); ++i) {
    const auto cause = static_cast<Cause>(i);
    if (counters[cause] == 0 || cause == first) continue;
    out.emplace_back();
    out.back().cause() = std::string(to_name(cause));
    out.back().count(counters[cause]);
  }
}

void to_idl(const std::vector<std::string>& addresses, std::vector<idl::RefusedAddress>& out) {
  out.resize(std::min(addresses.size(), kMaxRefused));
  for (std::size_t i = 0; i < out.size(); ++i)
    out[i].at() = cut_text(addresses[i], kMaxRefusedText);
}

CauseCounts from_idl(const std::vector<idl::CauseCount>& counts) {
  CauseCounts out;
  for (const idl::CauseCount& count : counts) out[count.cause().c_str()] = count.count();
  return out;
}

}  // namespace

void to_idl(std::string_view bridge, std::string_view bus, const BusReport& report, UtcTime at,
            idl::BusStatus& out) {
  out.bus() = cut_text(bus, kMaxNameLength);
  out.bridge() = cut_text(bridge, kMaxNameLength);
  out.state(to_idl(report.state));
  out.utilisation(report.utilisation);
  out.planned_load(report.planned_load);
  out.measured_load(report.measured_load);
  out.stretch(report.stretch);
  out.exchanges(report.exchanges);
  out.samples(report.samples);
  out.commands(report.commands);
  out.deadline_misses(report.deadline_misses);
  out.bytes_sent(report.bytes_sent);
  out.bytes_received(report.bytes_received);
  out.reopened(report.reopened);
  to_idl(report.causes, out.causes(), report.closed_because);
  to_idl(report.misses, out.misses());
  out.reported_at(at.nanoseconds);
}

StationBusStatus from_idl(const idl::BusStatus& status) {
  StationBusStatus out;
  out.bridge = status.bridge().c_str();
  out.bus = status.bus().c_str();
  BusReport& report = out.report;
  report.state = from_idl(status.state()).value_or(BusState::kStopped);
  report.utilisation = status.utilisation();
  report.planned_load = status.planned_load();
  report.measured_load = status.measured_load();
  report.stretch = status.stretch();
  report.exchanges = status.exchanges();
  report.samples = status.samples();
  report.commands = status.commands();
  report.deadline_misses = status.deadline_misses();
  report.bytes_sent = status.bytes_sent();
  report.bytes_received = status.bytes_received();
  report.reopened = status.reopened();
  out.dds_deadline_misses = status.dds_deadline_misses();
  if (report.state == BusState::kClosed && !status.causes().empty())
    report.closed_because = cause_named(status.causes().front().cause().c_str());
  out.causes = from_idl(status.causes());
  out.misses = from_idl(status.misses());
  out.reported_at = {status.reported_at()};
  return out;
}

void to_idl(std::string_view bus, std::string_view device, const DeviceReport& report, UtcTime at,
            idl::DeviceStatus& out) {
  out.bus() = cut_text(bus, kMaxNameLength);
  out.device() = cut_text(device, kMaxNameLength);
  out.state(to_idl(report.state));
  out.exchanges(report.exchanges);
  out.failures(report.failures);
  out.retries(report.retries);
  out.deadline_misses(report.deadline_misses);
  out.answer_time(report.response_time.count());
  out.answer_spread(report.response_spread.count());
  out.timeout(report.timeout.count());
  out.pause(report.pause.count());
  out.areas().resize(std::min(report.areas.size(), kMaxAreas));
  for (std::size_t i = 0; i < out.areas().size(); ++i) {
    const AreaReport& learned = report.areas[i];
    idl::LearnedArea& area = out.areas()[i];
    area.area() = cut_text(learned.area, kMaxAreaText);
    area.answer_time(learned.response_time.count());
    area.answer_spread(learned.response_spread.count());
    area.largest_block(learned.largest_block);
    area.longest_block(learned.longest_block);
  }
  to_idl(report.refused, out.refused());
  to_idl(report.refused_gaps, out.refused_gaps());
  to_idl(report.causes, out.causes());
  out.reported_at(at.nanoseconds);
}

StationDeviceStatus from_idl(const idl::DeviceStatus& status) {
  StationDeviceStatus out;
  out.bus = status.bus().c_str();
  out.device = status.device().c_str();
  DeviceReport& report = out.report;
  report.state = from_idl(status.state()).value_or(DeviceState::kUnknown);
  report.exchanges = status.exchanges();
  report.failures = status.failures();
  report.retries = status.retries();
  report.deadline_misses = status.deadline_misses();
  report.response_time = Duration{status.answer_time()};
  report.response_spread = Duration{status.answer_spread()};
  report.timeout = Duration{status.timeout()};
  report.pause = Duration{status.pause()};
  for (const idl::LearnedArea& area : status.areas())
    report.areas.push_back({area.area().c_str(), Duration{area.answer_time()},
                            Duration{area.answer_spread()}, area.largest_block(),
                            area.longest_block()});
  for (const idl::RefusedAddress& refused : status.refused())
    report.refused.emplace_back(refused.at().c_str());
  for (const idl::RefusedAddress& gap : status.refused_gaps())
    report.refused_gaps.emplace_back(gap.at().c_str());
  out.causes = from_idl(status.causes());
  out.reported_at = {status.reported_at()};
  return out;
}

void to_idl(std::string_view bridge, const BusSpec& bus, const DeviceSpec& device,
            idl::DeviceDescription& out) {
  out.bus() = cut_text(bus.name, kMaxNameLength);
  out.device() = cut_text(device.name, kMaxNameLength);
  out.bridge() = cut_text(bridge, kMaxNameLength);
  out.protocol() = cut_text(device.protocol, 64);
  out.port() = cut_text(to_text(bus.port), 128);
  out.address() = cut_text(address_text(device.link), 128);
  out.digits().clear();
  for (const ChannelSpec& channel : device.channels) {
    const std::optional<ShownDigits> shown = shown_digits(channel);
    if (!shown || (shown->digits == 0 && !shown->configured)) continue;
    if (out.digits().size() == kMaxDescribedChannels) return;
    idl::ChannelDigits& entry = out.digits().emplace_back();
    entry.channel() = cut_text(channel.name, kMaxNameLength);
    entry.digits(shown->digits);
    entry.configured(shown->configured);
  }
}

StationDeviceDescription from_idl(const idl::DeviceDescription& description) {
  StationDeviceDescription out{.bridge = description.bridge().c_str(),
                               .bus = description.bus().c_str(),
                               .device = description.device().c_str(),
                               .protocol = description.protocol().c_str(),
                               .port = description.port().c_str(),
                               .address = description.address().c_str(),
                               .digits = {}};
  for (const idl::ChannelDigits& entry : description.digits()) {
    if (entry.digits() <= kMostDigits)
      out.digits[entry.channel().c_str()] = {entry.digits(), entry.configured()};
  }
  return out;
}

void to_idl(const ProgramSessionReport& report, idl::ProgramSession& out) {
  out.bus() = cut_text(report.bus, kMaxNameLength);
  out.device() = cut_text(report.device, kMaxNameLength);
  out.state(to_idl(report.state));
  out.who() = cut_text(report.who, 128);
  out.bytes_to_device(report.bytes_to_device);
  out.bytes_from_device(report.bytes_from_device);
  out.since(report.since.nanoseconds);
}

ProgramSessionReport from_idl(const idl::ProgramSession& session) {
  ProgramSessionReport out;
  out.bus = session.bus().c_str();
  out.device = session.device().c_str();
  out.state = from_idl(session.state()).value_or(ProgramSessionState::kClosed);
  out.who = session.who().c_str();
  out.bytes_to_device = session.bytes_to_device();
  out.bytes_from_device = session.bytes_from_device();
  out.since = {session.since()};
  return out;
}

void to_idl(const ProgramRequestReport& report, idl::ProgramRequest& out) {
  out.bus() = cut_text(report.bus, kMaxNameLength);
  out.device() = cut_text(report.device, kMaxNameLength);
  out.request() = cut_text(report.request, 128);
  out.sent_at(report.sent_at.nanoseconds);
}

ProgramRequestReport from_idl(const idl::ProgramRequest& request) {
  ProgramRequestReport out;
  out.bus = request.bus().c_str();
  out.device = request.device().c_str();
  out.request = request.request().c_str();
  out.sent_at = {request.sent_at()};
  return out;
}

void to_idl(const AuditReport& report, idl::Audit& out) {
  out.bridge() = cut_text(report.bridge, kMaxNameLength);
  out.epoch(report.epoch);
  out.number(report.number);
  out.at(report.at.nanoseconds);
  out.who() = cut_text(report.who, 256);
  out.what() = cut_text(report.what, 128);
  out.target() = cut_text(report.target, 256);
  out.bytes_to_device(report.bytes_to_device);
  out.bytes_from_device(report.bytes_from_device);
  out.result() = cut_text(report.result, 256);
}

AuditReport from_idl(const idl::Audit& audit) {
  AuditReport out;
  out.bridge = audit.bridge().c_str();
  out.epoch = audit.epoch();
  out.number = audit.number();
  out.at = {audit.at()};
  out.who = audit.who().c_str();
  out.what = audit.what().c_str();
  out.target = audit.target().c_str();
  out.bytes_to_device = audit.bytes_to_device();
  out.bytes_from_device = audit.bytes_from_device();
  out.result = audit.result().c_str();
  return out;
}

}  // namespace fieldcast
