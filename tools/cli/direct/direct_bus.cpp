#include "tools/cli/direct/direct_bus.hpp"

#include <fmt/format.h>

#include <condition_variable>
#include <filesystem>
#include <mutex>
#include <ostream>

#include "bridge/base/io_thread.hpp"
#include "bridge/bus/bus_runner.hpp"
#include "bridge/log/log.hpp"
#include "config/sections/bus.hpp"
#include "config/sections/port.hpp"
#include "core/model/bus_spec.hpp"
#include "core/model/port_spec.hpp"
#include "core/protocol/option_reader.hpp"
#include "tools/cli/direct/line_exchange.hpp"
#include "tools/cli/text/output.hpp"

namespace fieldcast::cli {

namespace {

constexpr std::chrono::milliseconds kInterruptCheck{50};
constexpr std::chrono::milliseconds kTraceFlush{200};
constexpr std::chrono::hours kResultLimit{24};  // the engine completes every command long before

class Results final : public BusSink {
 public:
  struct Heard {
    bool running = false;
    std::string closed;  // why the port closed; empty: it is open
    std::optional<CommandResult> result;
  };

  // Empty after `limit` or an interrupt. Calls `meanwhile` regularly.
  template <class Enough, class Meanwhile>
  std::optional<Heard> wait(const Interrupt& interrupt, Duration limit, const Enough& enough,
                            const Meanwhile& meanwhile) {
    const auto end = std::chrono::steady_clock::now() + limit;
    std::unique_lock lock(mutex_);
    while (!enough(heard_)) {
      if (interrupt.raised() || std::chrono::steady_clock::now() >= end) return std::nullopt;
      changed_.wait_for(lock, kInterruptCheck);
      lock.unlock();
      meanwhile();
      lock.lock();
    }
    return heard_;
  }
  void forget_result() {
    change([](Heard& heard) { heard.result.reset(); });
  }

  void complete(const CommandResult& result, const UtcMapping&) override {
    change([&](Heard& heard) { heard.result = result; });
  }
  void report(const BusReport& report, UtcTime) override {
    change([&](Heard& heard) {
      heard.running = report.state == BusState::kRunning;
      heard.closed =
          report.closed_because == Cause::kNone ? "" : std::string(to_text(report.closed_because));
    });
  }
  void publish(std::vector<Sample>, const UtcMapping&) override {}
  void promise(ChannelIndex, std::optional<Duration>) override {}
  void report(std::string_view, const DeviceReport&, UtcTime) override {}
  void report(PlanReport, UtcTime) override {}

 private:
  template <class Change>
  void change(const Change& what) {
    const std::lock_guard lock(mutex_);
    what(heard_);
    changed_.notify_all();
  }

  std::mutex mutex_;
  std::condition_variable changed_;
  Heard heard_;
};

}  // namespace

struct DirectBus::State {
  State(const BusSpec& bus, bool trace, LineCapture* given)
      : port(name_of(bus.port)), capture(given), runner(io, plans.context(), bus, results) {
    open_log(LogLevel::kWarning);
    runner.set_trace(trace);
    if (capture != nullptr) runner.set_capture(capture->tap());
    runner.start();
  }
  ~State() { (void)runner.stop().wait_for(std::chrono::seconds{2}); }

  void write_capture() const {
    if (capture != nullptr) capture->write();
  }

  const std::string port;
  LineCapture* const capture;
  std::uint64_t commands = 0;
  Results results;
  IoThread io{"line"};
  IoThread plans{"plans"};
  BusRunner runner;
};

DirectBus::DirectBus(const BusSpec& bus, bool trace, LineCapture* capture)
    : state_(std::make_unique<State>(bus, trace, capture)) {}

DirectBus::~DirectBus() {
  state_.reset();
  flush_log(kTraceFlush);
}

tl::expected<void, std::string> DirectBus::open(const Interrupt& interrupt) {
  const auto known = [](const Results::Heard& heard) {
    return heard.running || !heard.closed.empty();
  };
  const auto heard =
      state_->results.wait(interrupt, kOpenLimit, known, [this] { state_->write_capture(); });
  if (heard && heard->running) return {};
  if (interrupt.raised()) return tl::unexpected(std::string());
  return tl::unexpected(state_->port + ": " + (heard ? heard->closed : "it does not open"));
}

std::optional<CommandResult> DirectBus::run(fieldcast::Command command,
                                            const Interrupt& interrupt) {
  command.requester = "command line";
  command.request_id = ++state_->commands;
  state_->results.forget_result();
  if (!state_->runner.post(std::move(command))) return std::nullopt;
  const auto has_result = [](const Results::Heard& heard) { return heard.result.has_value(); };
  const auto heard = state_->results.wait(interrupt, kResultLimit, has_result,
                                          [this] { state_->write_capture(); });
  return heard ? heard->result : std::nullopt;
}

namespace {

constexpr std::string_view kUdp = "udp:", kTls = "tls:", kRfc2217 = "rfc2217:";
bool is_rfc2217(std::string_view port) { return port.starts_with(kRfc2217); }
bool is_path(const std::string& port) { return full_port(port).find('/') != std::string::npos; }

// Empty if the protocol has no such address. Only declared protocols have texts and long numbers.
std::optional<DeviceLink> address_of(const std::string& text,
                                     const declared::Declaration* declaration) {
  DeviceLink link;
  const auto number = whole_number(text);
  const bool digits = !text.empty() && text.find_first_not_of("0123456789") == std::string::npos;
  const bool in_range = number && *number <= UINT16_MAX;
  if (in_range) link.address = static_cast<std::uint16_t>(*number);
  if (declaration != nullptr && (declaration->address_characters != 0 || (digits && !in_range)))
    link.long_address = text;
  return in_range || !link.long_address.empty() ? std::optional(link) : std::nullopt;
}

tl::expected<std::map<std::string, std::string>, std::string> settings_of(
    const LineOptions& options) {
  std::map<std::string, std::string> settings;
  for (const std::string& setting : options.settings) {
    const auto equals = setting.find('=');
    if (equals == 0 || equals == std::string::npos)
      return tl::unexpected(fmt::format("--set '{}' is not NAME=VALUE", printable(setting)));
    settings[setting.substr(0, equals)] = setting.substr(equals + 1);
  }
  return settings;
}

}  // namespace

std::string full_port(const std::string& port) {
  if (port.find_first_of("/:") != std::string::npos) return port;
  std::error_code ignored;
  if (std::filesystem::exists(port, ignored)) return "./" + port;
  const std::string device = "/dev/" + port;
  return port.starts_with("tty") || std::filesystem::exists(device, ignored) ? device : port;
}

void add_line_options(CommandLine& line, LineOptions& options) {
  line.text("PORT", options.port,
            "A serial port (/dev/ttyUSB0, ttyUSB0), HOST:PORT, udp:HOST:PORT, tls:HOST:PORT or "
            "rfc2217:HOST:PORT")
      .required();
  line.text("--protocol", options.protocol,
            std::string(kProtocolHelp) + " (modbus-rtu; for HOST:PORT modbus-tcp)");
  line.number("--baud", options.baud, kLowestBaud, kHighestBaud,
              "Of the line (what the protocol's devices have from the factory)");
  line.text("--format", options.format, "Data bits, parity, stop bits: 8N1, 8E1, 7E2, ..");
  line.text("--address", options.address, "Of the device (1)");
  line.texts("--set", options.settings, "NAME=VALUE: an option of the protocol; once for each")
      .one_each();
  line.duration("--timeout", options.timeout, CommandLine::kShortest,
                "To the first byte of a response (500ms)");
  line.number("--retries", options.retries, 0, 10, "More tries after no response (1)");
  line.text("--ca", options.tls.authority,
            "With tls: PEM file with who signs the certificate of the device, or with it");
  line.text("--certificate", options.tls.certificate, "With tls: PEM file of this client");
  line.text("--key", options.tls.key, "With tls: PEM file of its private key");
  line.text("--server-name", options.server_name,
            "With tls: the name in the certificate of the device (HOST)");
}

std::string protocol_of(const LineOptions& options) {
  if (!options.protocol.empty()) return options.protocol;
  return is_path(options.port) || is_rfc2217(options.port) ? "modbus-rtu" : "modbus-tcp";
}

namespace {

std::optional<std::string> tls_fault(const LineOptions& options, bool tls) {
  const TlsSpec& files = options.tls;
  const bool all = !files.authority.empty() && !files.certificate.empty() && !files.key.empty();
  if (tls && !all) return "tls:HOST:PORT needs --ca, --certificate and --key";
  if (!tls && (files != TlsSpec{} || !options.server_name.empty()))
    return "--ca, --certificate, --key and --server-name are for tls:HOST:PORT";
  return std::nullopt;
}

}  // namespace

tl::expected<PortSpec, std::string> port_of(const LineOptions& options, const LineFormat& factory) {
  LineFormat line = factory;
  if (!options.format.empty()) {
    const auto format = config::format_from(options.format);
    if (!format)
      return tl::unexpected(fmt::format("format '{}' is unknown; write 8N1, 8E1, 8O1, 8N2, 7E2, ..",
                                        printable(options.format)));
    line = *format;
    line.baud = factory.baud;
  }
  if (options.baud) line.baud = *options.baud;
  if (is_path(options.port)) {
    SerialPortSpec port;
    port.path = full_port(options.port);
    port.line = line;
    return port;
  }
  std::string_view place = options.port;
  const bool datagrams = place.starts_with(kUdp), tls = place.starts_with(kTls),
             rfc2217 = is_rfc2217(place);
  place.remove_prefix(datagrams || tls ? kUdp.size() : rfc2217 ? kRfc2217.size() : 0);
  const auto host = config::host_port_from(place);
  if (!host)
    return tl::unexpected(
        fmt::format("'{}' is none of a serial port (/dev/ttyUSB0), HOST:PORT, udp:HOST:PORT, "
                    "tls:HOST:PORT and rfc2217:HOST:PORT",
                    printable(options.port)));
  if (const auto fault = tls_fault(options, tls)) return tl::unexpected(*fault);
  if (rfc2217) return Rfc2217PortSpec{host->first, host->second, line};
  TcpPortSpec port;
  port.host = host->first;
  port.port = host->second;
  port.datagrams = datagrams;
  if (tls) port.tls = options.tls;
  port.server_name = options.server_name;
  if (options.baud || !options.format.empty()) port.line = line;
  return port;
}

tl::expected<BusSpec, std::string> bus_of(const LineOptions& options,
                                          const NamedProtocol& protocol) {
  const LineFormat factory =
      protocol.built_in != nullptr ? protocol.built_in->factory_line : LineFormat{};
  auto port = port_of(options, factory);
  if (!port) return tl::unexpected(std::move(port.error()));
  if (protocol.built_in != nullptr && protocol.built_in->network_only && !over_network(*port))
    return tl::unexpected(fmt::format("{} needs HOST:PORT; on a serial port it is {}",
                                      protocol.name(), protocol.built_in->instead));
  BusSpec bus;
  bus.name = "line";
  bus.port = *std::move(port);
  DeviceSpec& device = bus.devices.emplace_back();
  device.name = "device";
  device.protocol = protocol.name();
  device.declaration = protocol.declaration;
  device.timeout = options.timeout;
  device.retries = options.retries;
  device.allow_raw_read = device.allow_raw_write = true;
  const auto address = address_of(options.address, protocol.declaration.value.get());
  if (!address)
    return tl::unexpected(
        fmt::format("--address '{}' is no number 0 to 65535", printable(options.address)));
  device.link = *address;
  auto settings = settings_of(options);
  if (!settings) return tl::unexpected(std::move(settings.error()));
  device.link.options = *std::move(settings);
  const auto made = make_protocol(device, line_of(bus.port));
  if (!made) {
    const OptionFault& fault = made.error();
    const std::string option = fault.option.empty() ? "--address" : "--set " + fault.option;
    return tl::unexpected(fmt::format("{}: {}; allowed: {}", printable(option),
                                      printable(fault.what), fault.allowed));
  }
  const Traits& traits = (*made)->traits();
  if (device.link.long_address.empty() &&
      (device.link.address < traits.lowest_address || device.link.address > traits.highest_address))
    return tl::unexpected(fmt::format("--address {}: devices of {} have {} to {}", options.address,
                                      protocol.name(), traits.lowest_address,
                                      traits.highest_address));
  if (auto fault = config::port_fault(bus))
    return tl::unexpected(fault->what + "; " + fault->allowed);
  return bus;
}

ExitCode on_direct_bus(const DirectRun& run, const Interrupt& interrupt, std::ostream& err,
                       const std::function<ExitCode(DirectBus& bus)>& work) {
  return on_line(run.capture, run.bus, run.command, err, [&](LineCapture* capture) {
    DirectBus bus(run.bus, run.trace, capture);
    const auto opened = bus.open(interrupt);
    if (opened) return work(bus);
    if (interrupt.raised()) return ExitCode::kInterrupted;
    err << "fieldcast " << run.command << ": " << printable(opened.error()) << '\n';
    return ExitCode::kTrouble;
  });
}

}  // namespace fieldcast::cli
