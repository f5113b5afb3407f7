#include "bridge/metrics/metrics_text.hpp"

#include <fmt/format.h>

#include <array>
#include <iterator>

#include "core/base/value.hpp"

namespace fieldcast {
namespace {

enum class Kind : std::uint8_t { kCounter, kGauge };

struct Family {
  std::string_view name;  // of a counter: without "_total"
  Kind kind;
  std::string_view unit;  // suffix of the name, or empty
  std::string_view help;
};

std::string number(std::uint64_t value) { return std::to_string(value); }
std::string number(double value) { return number_text(value); }
std::string number(Duration value) { return number_text(to_seconds(value)); }

// A metric with one line for each owner: a bus, a device, an area.
template <typename Owner>
struct Row {
  Family family;
  std::string (*value)(const Owner&);
};

// A metric with one line for each cause that has occurred.
template <typename Owner>
struct CauseRow {
  Family family;
  const CauseCounters& (*counters)(const Owner&);
};

// An owner with its labels as text: bus="a",device="b".
template <typename Owner>
struct Labelled {
  std::string labels;
  const Owner* owner;
};

constexpr Row<BusFigures> kBusRows[] = {
    {{"fieldcast_bus_report_timestamp_seconds", Kind::kGauge, "seconds",
      "Unix time of the last report of the bus, which comes every second."},
     [](const BusFigures& bus) { return number(Duration{bus.at.nanoseconds}); }},
    {{"fieldcast_bus_utilisation_ratio", Kind::kGauge, "ratio",
      "Share of the last second in which the wire was busy or had to be silent."},
     [](const BusFigures& bus) { return number(bus.report.utilisation); }},
    {{"fieldcast_bus_planned_load_ratio", Kind::kGauge, "ratio",
      "Share of the wire that the read plan needs."},
     [](const BusFigures& bus) { return number(bus.report.planned_load); }},
    {{"fieldcast_bus_measured_load_ratio", Kind::kGauge, "ratio",
      "Share of the wire that reading took over the last 10 s."},
     [](const BusFigures& bus) { return number(bus.report.measured_load); }},
    {{"fieldcast_bus_stretch_ratio", Kind::kGauge, "ratio",
      "Factor on refreshes under overload; 1 without overload."},
     [](const BusFigures& bus) { return number(bus.report.stretch); }},
    {{"fieldcast_bus_silence_seconds", Kind::kGauge, "seconds",
      "Silence between a response and the next request: configured, or learned."},
     [](const BusFigures& bus) { return number(bus.report.silence); }},
    {{"fieldcast_bus_exchanges", Kind::kCounter, "", "Exchanges with devices of the bus."},
     [](const BusFigures& bus) { return number(bus.report.exchanges); }},
    {{"fieldcast_bus_samples", Kind::kCounter, "", "Samples published."},
     [](const BusFigures& bus) { return number(bus.report.samples); }},
    {{"fieldcast_bus_commands", Kind::kCounter, "",
      "Commands that were run, also those that failed."},
     [](const BusFigures& bus) { return number(bus.report.commands); }},
    {{"fieldcast_bus_deadline_misses", Kind::kCounter, "", "Refreshes that were missed."},
     [](const BusFigures& bus) { return number(bus.report.deadline_misses); }},
    {{"fieldcast_bus_sent_bytes", Kind::kCounter, "bytes", "Bytes sent on the wire."},
     [](const BusFigures& bus) { return number(bus.report.bytes_sent); }},
    {{"fieldcast_bus_received_bytes", Kind::kCounter, "bytes", "Bytes received from the wire."},
     [](const BusFigures& bus) { return number(bus.report.bytes_received); }},
    {{"fieldcast_bus_reopenings", Kind::kCounter, "", "Times that the port was opened again."},
     [](const BusFigures& bus) { return number(bus.report.reopened); }},
};

constexpr CauseRow<BusFigures> kBusCauseRows[] = {
    {{"fieldcast_bus_failed_exchanges", Kind::kCounter, "", "Exchanges that failed, by cause."},
     [](const BusFigures& bus) -> const CauseCounters& { return bus.report.causes; }},
    {{"fieldcast_bus_missed_refreshes", Kind::kCounter, "", "Refreshes missed, by cause."},
     [](const BusFigures& bus) -> const CauseCounters& { return bus.report.misses; }},
};

constexpr Row<BusFigures> kDdsRows[] = {
    {{"fieldcast_dds_deadline_misses", Kind::kCounter, "",
      "Deadlines that the writers of fieldcast/Sample offered and missed."},
     [](const BusFigures& bus) { return number(bus.dds.deadline_misses); }},
    {{"fieldcast_dds_sample_writers", Kind::kGauge, "", "Writers of fieldcast/Sample."},
     [](const BusFigures& bus) { return number(std::uint64_t{bus.dds.sample_writers}); }},
    {{"fieldcast_dds_sample_readers", Kind::kGauge, "",
      "Readers of fieldcast/Sample, at the writer that has the most."},
     [](const BusFigures& bus) { return number(std::uint64_t{bus.dds.sample_readers}); }},
    {{"fieldcast_dds_blocks", Kind::kCounter, "", "Messages written to fieldcast/SampleBlock."},
     [](const BusFigures& bus) { return number(bus.dds.blocks); }},
    {{"fieldcast_dds_block_readers", Kind::kGauge, "", "Readers of fieldcast/SampleBlock."},
     [](const BusFigures& bus) { return number(std::uint64_t{bus.dds.block_readers}); }},
};

constexpr Row<GatewayFigures> kGatewayRows[] = {
    {{"fieldcast_gateway_clients", Kind::kGauge, "", "Connected Modbus TCP clients."},
     [](const GatewayFigures& gateway) { return number(gateway.counters.clients); }},
    {{"fieldcast_gateway_refused_clients", Kind::kCounter, "",
      "Clients that were not permitted, were too many, or did not send Modbus TCP."},
     [](const GatewayFigures& gateway) { return number(gateway.counters.refused_clients); }},
    {{"fieldcast_gateway_requests", Kind::kCounter, "", "Requests of Modbus TCP clients."},
     [](const GatewayFigures& gateway) { return number(gateway.counters.requests); }},
    {{"fieldcast_gateway_refused_requests", Kind::kCounter, "",
      "Requests of Modbus TCP clients whose response is an exception."},
     [](const GatewayFigures& gateway) { return number(gateway.counters.refused_requests); }},
};

constexpr Row<DeviceFigures> kDeviceRows[] = {
    {{"fieldcast_device_exchanges", Kind::kCounter, "", "Exchanges with the device."},
     [](const DeviceFigures& device) { return number(device.report.exchanges); }},
    {{"fieldcast_device_failures", Kind::kCounter, "", "Exchanges that failed."},
     [](const DeviceFigures& device) { return number(device.report.failures); }},
    {{"fieldcast_device_retries", Kind::kCounter, "", "Exchanges that were tried again."},
     [](const DeviceFigures& device) { return number(device.report.retries); }},
    {{"fieldcast_device_deadline_misses", Kind::kCounter, "", "Refreshes that were missed."},
     [](const DeviceFigures& device) { return number(device.report.deadline_misses); }},
    {{"fieldcast_device_answer_seconds", Kind::kGauge, "seconds",
      "Learned time from the end of a request to the first byte of the response."},
     [](const DeviceFigures& device) { return number(device.report.response_time); }},
    {{"fieldcast_device_answer_spread_seconds", Kind::kGauge, "seconds",
      "Learned spread of that time."},
     [](const DeviceFigures& device) { return number(device.report.response_spread); }},
    {{"fieldcast_device_timeout_seconds", Kind::kGauge, "seconds",
      "Timeout in force; never above the configured one."},
     [](const DeviceFigures& device) { return number(device.report.timeout); }},
    {{"fieldcast_device_pause_seconds", Kind::kGauge, "seconds",
      "Pause kept after responses of the device; configured or learned."},
     [](const DeviceFigures& device) { return number(device.report.pause); }},
    {{"fieldcast_device_refused_addresses", Kind::kGauge, "",
      "Addresses that the device refuses at present; counted up to 64."},
     [](const DeviceFigures& device) {
       return number(std::uint64_t{device.report.refused.size()});
     }},
    {{"fieldcast_device_refused_gaps", Kind::kGauge, "",
      "Gaps between addresses that no read may bridge; counted up to 64."},
     [](const DeviceFigures& device) {
       return number(std::uint64_t{device.report.refused_gaps.size()});
     }},
};

constexpr CauseRow<DeviceFigures> kDeviceCauseRows[] = {
    {{"fieldcast_device_failed_exchanges", Kind::kCounter, "", "Exchanges that failed, by cause."},
     [](const DeviceFigures& device) -> const CauseCounters& { return device.report.causes; }},
};

constexpr Row<AreaReport> kAreaRows[] = {
    {{"fieldcast_device_area_answer_seconds", Kind::kGauge, "seconds",
      "Learned time to the first byte of a response about the area."},
     [](const AreaReport& area) { return number(area.response_time); }},
    {{"fieldcast_device_area_answer_spread_seconds", Kind::kGauge, "seconds",
      "Learned spread of that time."},
     [](const AreaReport& area) { return number(area.response_spread); }},
    {{"fieldcast_device_area_largest_block", Kind::kGauge, "",
      "Most items of the area that were read in one block."},
     [](const AreaReport& area) { return number(std::uint64_t{area.largest_block}); }},
    {{"fieldcast_device_area_longest_block", Kind::kGauge, "",
      "Most items that the device accepts in one block, since it refused more; 0: none refused."},
     [](const AreaReport& area) { return number(std::uint64_t{area.longest_block}); }},
};

constexpr Family kAlarms{"fieldcast_alarms", Kind::kGauge, "",
                         "Alarms of each state; those that are clear are not counted."};
constexpr Row<AlarmCounts> kAlarmRows[] = {
    {{"fieldcast_chattering_alarms", Kind::kGauge, "",
      "Alarms with five or more occurrences within 10 minutes."},
     [](const AlarmCounts& alarms) { return number(std::uint64_t{alarms.chattering}); }},
};

constexpr Row<StandbyFigures> kStandbyRows[] = {
    {{"fieldcast_standby_master", Kind::kGauge, "", "1: this bridge is master of its group."},
     [](const StandbyFigures& standby) { return number(std::uint64_t{standby.master}); }},
    {{"fieldcast_standby_ready", Kind::kGauge, "", "1: it is master, or could take over."},
     [](const StandbyFigures& standby) { return number(std::uint64_t{standby.ready}); }},
    {{"fieldcast_standby_term", Kind::kGauge, "", "Number of the mastership that it knows."},
     [](const StandbyFigures& standby) { return number(std::uint64_t{standby.term}); }},
    {{"fieldcast_standby_takeovers", Kind::kCounter, "", "Times that this bridge became master."},
     [](const StandbyFigures& standby) { return number(standby.takeovers); }},
    {{"fieldcast_standby_behind", Kind::kGauge, "",
      "Blocks of samples of the master that it does not have yet."},
     [](const StandbyFigures& standby) { return number(standby.behind); }},
};

constexpr Row<StoreCounters> kStoreRows[] = {
    {{"fieldcast_store_samples", Kind::kCounter, "", "Samples in committed transactions."},
     [](const StoreCounters& store) { return number(store.stored); }},
    {{"fieldcast_store_dropped_samples", Kind::kCounter, "",
      "Samples that did not fit the queue or whose batch was dropped."},
     [](const StoreCounters& store) { return number(store.dropped); }},
    {{"fieldcast_store_quarantined_rows", Kind::kCounter, "",
      "Samples and events that the database refused; they are in its table quarantine."},
     [](const StoreCounters& store) { return number(store.quarantined); }},
    {{"fieldcast_store_waiting_samples", Kind::kGauge, "", "Samples that wait to be written."},
     [](const StoreCounters& store) { return number(std::uint64_t{store.waiting}); }},
};

constexpr Family kBridge{"fieldcast_bridge_info", Kind::kGauge, "", "1, with the bridge's name."};
constexpr Family kReceiveBuffer{"fieldcast_dds_receive_buffer_bytes", Kind::kGauge, "bytes",
                                "What the kernel grants a UDP socket of this process."};
constexpr Family kRefusedDatagrams{"fieldcast_dds_refused_datagrams", Kind::kCounter, "",
                                   "Datagrams that the guard kept from DDS, by cause."};
constexpr Family kBusState{"fieldcast_bus_state", Kind::kGauge, "",
                           "1 for the state that the bus is in, 0 for the others."};
constexpr Family kClosed{"fieldcast_bus_closed", Kind::kGauge, "",
                         "1 while the port is closed, with the cause."};
constexpr Family kDeviceState{"fieldcast_device_state", Kind::kGauge, "",
                              "1 for the state that the device is in, 0 for the others."};

constexpr std::array kBusStates = {BusState::kOpening, BusState::kRunning, BusState::kClosed,
                                   BusState::kLeased, BusState::kStopped};
constexpr std::array kDeviceStates = {DeviceState::kUnknown, DeviceState::kOnline,
                                      DeviceState::kDegraded, DeviceState::kOffline};

std::string label(std::string_view name, std::string_view value) {
  return fmt::format("{}=\"{}\"", name, escaped_label(value));
}

// Writes families in sequence; omits a family without lines.
class Writer {
 public:
  explicit Writer(MetricsFormat format) : format_(format) {}

  void begin(const Family& family) {
    family_ = &family;
    headed_ = false;
    const bool total = family.kind == Kind::kCounter;
    sample_name_ = fmt::format("{}{}", family.name, total ? "_total" : "");
  }
  void line(std::string_view labels, std::string_view value) {
    if (!headed_) head();
    if (labels.empty())
      fmt::format_to(std::back_inserter(text_), "{} {}\n", sample_name_, value);
    else
      fmt::format_to(std::back_inserter(text_), "{}{{{}}} {}\n", sample_name_, labels, value);
  }
  [[nodiscard]] std::string take() {
    if (format_ == MetricsFormat::kOpenMetrics) text_ += "# EOF\n";
    return std::move(text_);
  }

 private:
  // In OpenMetrics, the family name of a counter has no "_total"; in the older format it has.
  void head() {
    headed_ = true;
    const bool open = format_ == MetricsFormat::kOpenMetrics;
    const std::string_view name = open ? family_->name : std::string_view(sample_name_);
    const std::string_view type = family_->kind == Kind::kCounter ? "counter" : "gauge";
    fmt::format_to(std::back_inserter(text_), "# HELP {} {}\n# TYPE {} {}\n", name, family_->help,
                   name, type);
    if (open && !family_->unit.empty())
      fmt::format_to(std::back_inserter(text_), "# UNIT {} {}\n", name, family_->unit);
  }

  const MetricsFormat format_;
  const Family* family_ = nullptr;
  std::string sample_name_;
  bool headed_ = false;
  std::string text_;
};

template <typename Owner, std::size_t kCount>
void write_rows(Writer& out, const Row<Owner> (&rows)[kCount],
                const std::vector<Labelled<Owner>>& owners) {
  for (const Row<Owner>& row : rows) {
    out.begin(row.family);
    for (const auto& [labels, owner] : owners) out.line(labels, row.value(*owner));
  }
}

template <typename Owner, std::size_t kCount>
void write_causes(Writer& out, const CauseRow<Owner> (&rows)[kCount],
                  const std::vector<Labelled<Owner>>& owners) {
  for (const CauseRow<Owner>& row : rows) {
    out.begin(row.family);
    for (const auto& [labels, owner] : owners) {
      const CauseCounters& counters = row.counters(*owner);
      for (std::size_t i = 1; i < static_cast<std::size_t>(Cause::kCount); ++i) {
        const auto cause = static_cast<Cause>(i);
        if (counters[cause] == 0) continue;
        out.line(labels + ',' + label("cause", to_name(cause)), number(counters[cause]));
      }
    }
  }
}

template <typename Owner, typename States>
void write_states(Writer& out, const Family& family, const States& states,
                  const std::vector<Labelled<Owner>>& owners) {
  out.begin(family);
  for (const auto& [labels, owner] : owners) {
    for (const auto state : states)
      out.line(labels + ',' + label("state", to_text(state)),
               owner->report.state == state ? "1" : "0");
  }
}

void write_buses(Writer& out, const MetricsSnapshot& snapshot) {
  std::vector<Labelled<BusFigures>> buses;
  for (const auto& bus : snapshot.buses) buses.push_back({label("bus", bus->bus), bus.get()});
  write_states(out, kBusState, kBusStates, buses);
  out.begin(kClosed);
  for (const auto& [labels, bus] : buses) {
    if (bus->report.state == BusState::kClosed)
      out.line(labels + ',' + label("cause", to_name(bus->report.closed_because)), "1");
  }
  write_rows(out, kBusRows, buses);
  write_causes(out, kBusCauseRows, buses);
  write_rows(out, kDdsRows, buses);
  std::vector<Labelled<GatewayFigures>> gateways;
  for (const auto& gateway : snapshot.gateways)
    gateways.push_back({label("bus", gateway.bus), &gateway});
  write_rows(out, kGatewayRows, gateways);
}

void write_devices(Writer& out, const MetricsSnapshot& snapshot) {
  std::vector<Labelled<DeviceFigures>> devices;
  std::vector<Labelled<AreaReport>> areas;
  for (const auto& device : snapshot.devices) {
    const std::string labels = label("bus", device->bus) + ',' + label("device", device->device);
    devices.push_back({labels, device.get()});
    for (const AreaReport& area : device->report.areas)
      areas.push_back({labels + ',' + label("area", area.area), &area});
  }
  write_states(out, kDeviceState, kDeviceStates, devices);
  write_rows(out, kDeviceRows, devices);
  write_causes(out, kDeviceCauseRows, devices);
  write_rows(out, kAreaRows, areas);
}

void write_alarms(Writer& out, const AlarmCounts& alarms) {
  const std::pair<std::string_view, std::size_t> states[] = {
      {"unacknowledged", alarms.unacknowledged},
      {"acknowledged", alarms.acknowledged},
      {"returned", alarms.returned},
      {"shelved", alarms.shelved},
      {"suppressed", alarms.suppressed}};
  out.begin(kAlarms);
  for (const auto& [state, count] : states)
    out.line(label("state", state), number(std::uint64_t{count}));
  write_rows(out, kAlarmRows, {{{}, &alarms}});
}

}  // namespace

std::string metrics_text(const MetricsSnapshot& snapshot, MetricsFormat format) {
  Writer out(format);
  out.begin(kBridge);
  out.line(label("bridge", snapshot.bridge), "1");
  write_buses(out, snapshot);
  write_devices(out, snapshot);
  out.begin(kRefusedDatagrams);
  for (std::size_t i = 0; i < kRtpsFaults; ++i) {
    if (snapshot.refused_datagrams[i] == 0) continue;
    out.line(label("cause", to_text(static_cast<RtpsFault>(i))),
             number(snapshot.refused_datagrams[i]));
  }
  if (snapshot.receive_buffer) {
    out.begin(kReceiveBuffer);
    out.line({}, number(std::uint64_t{*snapshot.receive_buffer}));
  }
  if (snapshot.alarms) write_alarms(out, *snapshot.alarms);
  if (snapshot.standby) {
    const std::vector<Labelled<StandbyFigures>> standby{{{}, &*snapshot.standby}};
    write_rows(out, kStandbyRows, standby);
  }
  if (snapshot.store) {
    const std::vector<Labelled<StoreCounters>> store{{{}, &*snapshot.store}};
    write_rows(out, kStoreRows, store);
  }
  return out.take();
}

std::string_view content_type_of(MetricsFormat format) {
  return format == MetricsFormat::kOpenMetrics
             ? "application/openmetrics-text; version=1.0.0; charset=utf-8"
             : "text/plain; version=0.0.4; charset=utf-8";
}

MetricsFormat format_for(std::string_view accept) {
  return accept.find("application/openmetrics-text") == accept.npos ? MetricsFormat::kPrometheus
                                                                    : MetricsFormat::kOpenMetrics;
}

std::string escaped_label(std::string_view value) {
  std::string out;
  out.reserve(value.size());
  for (const char c : value) {
    if (c == '\n') {
      out += "\\n";
      continue;
    }
    if (c == '\\' || c == '"') out += '\\';
    out += c;
  }
  return out;
}

}  // namespace fieldcast
