#include "tools/cli/command/line/scan.hpp"

#include <fmt/format.h>

#include <filesystem>
#include <ostream>

#include "config/files/template_match.hpp"
#include "tools/cli/command/base/command_run.hpp"
#include "tools/cli/direct/direct_bus.hpp"
#include "tools/cli/direct/line_exchange.hpp"
#include "tools/cli/import/import_files.hpp"
#include "tools/cli/model/sample_text.hpp"
#include "tools/cli/scan/identity.hpp"
#include "tools/cli/scan/scan_view.hpp"
#include "tools/cli/scan/scanner.hpp"
#include "tools/cli/scan/sunspec_view.hpp"
#include "tools/progress/progress_line.hpp"

namespace fieldcast::cli {
namespace {

constexpr std::chrono::milliseconds kUsualTimeout{200};  // until the first byte of a response

bool is_serial(const ScanOptions& options) { return options.port.find('/') != std::string::npos; }

PortSpec port_with(const PortSpec& port, const LineFormat& format) {
  PortSpec with = port;
  if (auto* serial = std::get_if<SerialPortSpec>(&with)) serial->line = format;
  return with;
}

// With a baud rate or a format, HOST:PORT is a serial server in front of a line.
tl::expected<PortSpec, std::string> scan_port(const ScanOptions& options,
                                              const NamedProtocol& protocol) {
  return port_of({.port = options.port, .baud = options.baud, .format = options.format},
                 protocol.factory_line());
}

tl::expected<std::vector<ScanLine>, std::string> lines_of(
    const ScanOptions& options, const std::vector<NamedProtocol>& protocols) {
  const bool serial = is_serial(options);
  const auto addresses = addresses_from(options.addresses);
  if (!addresses) return tl::unexpected(addresses.error());
  for (const std::string_view other : {"tls:", "rfc2217:"}) {
    if (options.port.starts_with(other))
      return tl::unexpected(fmt::format(
          "a scan searches a serial port or HOST:PORT; 'fieldcast read' accepts {}HOST:PORT",
          other));
  }
  const auto port = scan_port(options, protocols.front());
  if (!port) return tl::unexpected(port.error());
  std::optional<LineFormat> format;
  if (!options.format.empty()) format = line_of(*port);
  std::vector<ScanLine> lines;
  for (const NamedProtocol& protocol : protocols) {
    const ProtocolEntry* entry = protocol.built_in;
    if (serial && entry != nullptr && entry->network_only)
      return tl::unexpected(fmt::format("{} needs HOST:PORT; on a serial port it is {}",
                                        entry->name, entry->instead));
    if (has_usual_links(protocol) && options.addresses != ScanOptions{}.addresses)
      return tl::unexpected(
          fmt::format("--addresses is for devices of a line; HOST:PORT of {} is one controller, "
                      "whose usual links are tried",
                      protocol.name()));
    const LineFormat far = has_line(*port) ? line_of(*port) : protocol.factory_line();
    const auto formats =
        serial ? usual_formats(protocol, options.baud, format) : std::vector<LineFormat>{far};
    for (ScanLine& more : scan_lines(protocol, formats, *addresses))
      lines.push_back(std::move(more));
  }
  if (lines.empty())
    return tl::unexpected(
        fmt::format("the protocol has none of the addresses {}", options.addresses));
  const bool many = serial || std::ranges::any_of(lines, [](const ScanLine& each) {
                      return each.addresses.size() > 1;
                    });
  if (many && !options.all && !options.timeout &&
      silent_scan_time(lines, kUsualTimeout) > kQuickScan)
    plan_probes(lines);
  return lines;
}

// The line in a capture: one device for each tried protocol.
BusSpec captured_bus(const PortSpec& port, const std::vector<ScanLine>& lines) {
  BusSpec bus;
  bus.name = "line";
  bus.port = port;
  for (const ScanLine& line : lines) {
    if (!bus.devices.empty() && bus.devices.back().protocol == line.protocol.name()) continue;
    DeviceSpec& device = bus.devices.emplace_back();
    device.protocol = line.protocol.name();
    device.declaration = line.protocol.declaration;
  }
  return bus;
}
std::size_t protocol_index(const std::vector<ScanLine>& lines, std::size_t line) {
  std::size_t index = 0;
  for (std::size_t i = 1; i <= line; ++i)
    index += lines[i].protocol.name() != lines[i - 1].protocol.name();
  return index;
}

class Scan {
 public:
  Scan(const ScanOptions& options, PortSpec port, std::vector<ScanLine> lines,
       const Interrupt& interrupt, std::ostream& err, LineCapture* capture)
      : options_(options),
        port_(std::move(port)),
        serial_(is_serial(options)),
        scanner_(std::move(lines)),
        capture_(capture),
        progress_(err),
        talk_(interrupt, capture == nullptr ? nullptr : capture->tap()),
        interrupt_(interrupt) {
    talk_.while_waiting(
        [this] { progress_.show([this](Duration elapsed) { return progress(elapsed); }); });
  }

  // Runs to the end or an interrupt. Fails if the port does not open.
  tl::expected<void, std::string> run() {
    auto done = ask_all();
    progress_.clear();
    return done;
  }
  [[nodiscard]] const Scanner& scanner() const { return scanner_; }

 private:
  [[nodiscard]] ProgressText progress(Duration elapsed) const {
    if (scanner_.next()) return scan_progress(scanner_, elapsed, serial_);
    return {"asking who they are", fmt::format("{} of {}", named_, scanner_.found().size())};
  }

  tl::expected<void, std::string> ask_all() {
    while (const auto ask = scanner_.next()) {
      if (auto ready = turn_to(ask->line); !ready) {
        if (interrupt_.raised()) return {};
        return ready;
      }
      if (ask->first) {
        if (asked_line_ == ask->line) talk_.rest(kScanRest);
        talk_.listen_again();
      }
      asked_line_ = ask->line;
      if (questions_.empty()) {
        scanner_.skip_line();
        continue;
      }
      const auto response = question(*ask);
      if (interrupt_.raised()) return {};
      if (!response) return tl::unexpected(response.error());
      scanner_.on_response(*response);
    }
    const auto heads = config::template_heads(config::disk_reader(), config::default_options());
    for (; named_ < scanner_.found().size() && !interrupt_.raised(); ++named_) {
      const ScanFound& found = scanner_.found()[named_];
      std::string identity = identity_of(found);
      const std::string_view protocol = scanner_.lines()[found.line].protocol.name();
      scanner_.set_templates(named_, config::matching_templates(identity, protocol, heads));
      scanner_.set_identity(named_, std::move(identity));
      walk_sunspec(named_);
    }
    return {};
  }

  tl::expected<void, std::string> turn_to(std::size_t line) {
    if (line_ == line) return {};
    const ScanLine& next = scanner_.lines()[line];
    const bool has_session =
        next.protocol.built_in != nullptr && next.protocol.built_in->network_only;
    if (!line_ || serial_ || has_session) {
      if (auto opened = talk_.open(port_with(port_, next.format)); !opened) return opened;
      session_.clear();
    }
    // A quick search does not rest, because its time is limited: it finds such a device only on the
    // first line.
    if (line_ && serial_ && next.probes.empty()) talk_.rest(kScanRest);
    line_ = line;
    protocol_ = scan_protocol(next, next.addresses.front());
    questions_ = questions_of(next.protocol, *protocol_);
    return {};
  }

  [[nodiscard]] ExchangeContext context() { return {++sequence_, &session_}; }

  [[nodiscard]] std::unique_ptr<Protocol> device(std::uint16_t address) const {
    return scan_protocol(scanner_.lines()[*line_], address);
  }

  tl::expected<ScanResponse, std::string> question(const ScanAsk& ask) {
    const auto protocol = device(ask.address);
    if (!protocol) return ScanResponse{};
    const ScanQuestion& asked = questions_[std::min(ask.question, questions_.size() - 1)];
    const Duration timeout = ask.wait.value_or(options_.timeout.value_or(kUsualTimeout));
    auto heard = talk(protocol->begin(ReadRequest{{asked.range}}, context()), ask.address,
                      "reads " + asked.at, timeout);
    if (!heard && !serial_) return ScanResponse{.cause = Cause::kPortClosed};
    if (!heard) return tl::unexpected(std::move(heard.error()));
    ScanResponse response{.cause = heard->cause,
                          .device_code = heard->device_code,
                          .took = heard->took,
                          .bytes = heard->bytes,
                          .echo_alone = heard->echo_alone,
                          .heard = heard->heard,
                          .shape = heard->shape};
    if (response.cause == Cause::kNone && !heard->reply.empty()) {
      response.cause = heard->reply.front().cause;
      response.device_code = heard->reply.front().device_code;
    }
    // The connection is refused: there is no slot or TSAP as this one.
    const bool refused = response.cause == Cause::kMalformed && response.device_code != 0;
    if (response.cause == Cause::kNone || refused) response.shape = ResponseShape::kOther;
    if (refused) response.bytes = 0;
    response.device = response.cause == Cause::kNone || response.cause == Cause::kDeviceError ||
                      response.cause == Cause::kDeviceBusy;
    return response;
  }

  tl::expected<LineExchange::Response, std::string> talk(std::unique_ptr<Exchange> exchange,
                                                         std::uint16_t address,
                                                         const std::string& what,
                                                         Duration timeout) {
    auto heard = talk_.ask(
        std::move(exchange), timeout,
        {protocol_index(scanner_.lines(), *line_), fmt::format("address {}: {}", address, what)});
    if (capture_ != nullptr) capture_->write();
    // Closed, for example because the gateway has no such unit, or the controller no such link.
    if (!heard && !serial_) line_.reset();
    return heard;
  }

  std::string identity_of(const ScanFound& found) {
    if (!turn_to(found.line)) return {};
    const ScanLine& line = scanner_.lines()[found.line];
    const Duration timeout = options_.timeout.value_or(kUsualTimeout);
    if (auto exchange = identity_exchange(line, found.address, context())) {
      const auto heard = talk(std::move(exchange), found.address, "asks who it is", timeout);
      if (!heard || heard->cause != Cause::kNone) return {};
      const Bytes& text = heard->reply.front().items;
      return {text.begin(), text.end()};
    }
    const auto protocol = device(found.address);
    const auto identity = protocol ? identity_question(*protocol) : std::nullopt;
    if (!identity) return {};
    const auto heard = talk(protocol->begin(ReadRequest{{identity->question.range}}, context()),
                            found.address, "reads " + identity->question.at, timeout);
    if (!heard || heard->cause != Cause::kNone || heard->reply.front().cause != Cause::kNone)
      return {};
    const Bytes& items = heard->reply.front().items;
    if (identity->label.empty()) return {items.begin(), std::ranges::find(items, '\0')};
    std::uint64_t number = 0;
    for (const std::uint8_t byte : items) number = number << 8 | byte;
    return identity_text(*identity, std::to_string(number));
  }

  // Takes at most one timeout for a device without SunSpec models.
  void walk_sunspec(std::size_t index) {
    const ScanFound& found = scanner_.found()[index];
    if (!turn_to(found.line)) return;
    const auto protocol = device(found.address);
    if (!protocol || !may_have_sunspec(scanner_.lines()[found.line].protocol.name())) return;
    const auto area = protocol->parse_address("holding:0");
    SunSpecWalk walk;
    for (auto read = walk.next(); read && area && !interrupt_.raised(); read = walk.next()) {
      const auto heard =
          talk(protocol->begin(ReadRequest{{{area->area, read->first, read->count}}}, context()),
               found.address, fmt::format("reads holding:{}", read->first),
               options_.timeout.value_or(kUsualTimeout));
      if (!heard) break;
      const Cause cause = heard->cause != Cause::kNone || heard->reply.empty()
                              ? heard->cause
                              : heard->reply.front().cause;
      if (cause == Cause::kNone && !heard->reply.empty())
        walk.on_response(heard->reply.front().items);
      else
        walk.failed(cause);
    }
    if (walk.map() && !walk.next()) scanner_.set_sunspec(index, *walk.map());
  }

  const ScanOptions& options_;
  const PortSpec port_;
  const bool serial_;
  Scanner scanner_;
  LineCapture* const capture_;
  ProgressLine progress_;
  LineExchange talk_;
  const Interrupt& interrupt_;
  std::size_t named_ = 0;                  // number of devices that were identified
  std::optional<std::size_t> line_;        // current line of the port
  std::optional<std::size_t> asked_line_;  // of the last request
  std::unique_ptr<Protocol> protocol_;
  std::vector<ScanQuestion> questions_;
  std::uint16_t sequence_ = 0;
  Bytes session_;  // of the connection, see ExchangeContext
};

void explain_broken(const Scanner& scanner, bool serial, std::ostream& err) {
  for (const ScanBroken& broken : scanner.broken())
    err << "address " << broken.address << ", " << line_text(scanner.lines()[broken.line], serial)
        << ": bytes arrive that are not a valid response; " << broken_response_text(broken.shape)
        << '\n';
}

void explain_nothing(const ScanOptions& options, const Scanner& scanner, bool serial,
                     std::ostream& err) {
  if (scanner.silent() && !scanner.echoed()) {
    return print(err, silence_lines(options.port, scanner, serial, kUsualTimeout));
  }
  err << "no device responded to " << scanner.asked() << " requests on " << printable(options.port)
      << '\n';
  if (!scanner.broken().empty()) return explain_broken(scanner, serial, err);
  for (const std::size_t line : scanner.noisy_lines())
    err << "  bytes arrived that are not a response: " << line_text(scanner.lines()[line], serial)
        << '\n';
  if (scanner.echoed())
    err << "  what was sent comes back, and nothing else: the adapter gives back what it sends, "
           "and no device responds\n";
  if (!scanner.noisy_lines().empty()) {
    err << "another master may speak there, or the settings are others\n";
  } else if (!serial && scanner.lines().size() > 1) {
    for (const ScanLine& line : scanner.lines())
      err << "  tried: " << line_text(line, serial) << ", address " << line.addresses.front()
          << '\n';
    err << "the controller has another link, or none of its connections is free\n";
  } else if (serial) {
    err << "look at A and B (D+ and D-) of the line, its termination and the supply of the device; "
           "try --protocol, --addresses 1-247, --all, or a longer --timeout\n";
  }
}

void show(const ScanOptions& options, const Scanner& scanner, const Streams& to) {
  const bool serial = is_serial(options);
  if (options.json) {
    for (const ScanFound& found : scanner.found())
      to.out << found_json(options.port, scanner.lines()[found.line], found, serial).text() << '\n';
  } else {
    print(to.out, found_lines(scanner, serial, to.wide_screen()));
    print(to.out, template_lines(scanner));
  }
  to.out.flush();
}

ExitCode write_configuration(const ScanOptions& options, const PortSpec& port,
                             const Scanner& scanner, std::ostream& err) {
  const NewFile file{options.out,
                     configuration_text(options.port, is_serial(options), scanner, has_line(port))};
  if (const auto fault = write_new_files({file}, false)) {
    err << "fieldcast scan: " << *fault << '\n';
    return ExitCode::kTrouble;
  }
  err << "written: " << printable(options.out) << "; look at it with fieldcast-bridge --check "
      << printable(options.out) << '\n';
  return ExitCode::kOk;
}

}  // namespace

ExitCode scan(const ScanOptions& given, const Interrupt& interrupt, const Streams& to) {
  ScanOptions options = given;
  options.port = full_port(given.port);
  std::vector<std::string> names = options.protocols;
  if (names.empty()) names = {is_serial(options) ? "modbus-rtu" : "modbus-tcp"};
  std::vector<NamedProtocol> protocols;
  for (const std::string& name : names) {
    auto named = named_protocol(name, "scan", to.err);
    if (!named) return ExitCode::kUsage;
    protocols.push_back(*std::move(named));
  }
  auto lines = lines_of(options, protocols);
  if (!lines) return usage_fault(to.err, "scan", lines.error());
  std::error_code ignored;
  if (!options.out.empty() && std::filesystem::exists(options.out, ignored))
    return usage_fault(to.err, "scan", options.out + " is there already; it is not written over");
  const auto port = scan_port(options, protocols.front());
  const BusSpec captured = captured_bus(*port, *lines);
  return on_line(options.capture, captured, "scan", to.err, [&](LineCapture* capture) {
    Scan run(options, *port, *std::move(lines), interrupt, to.err, capture);
    const auto done = run.run();
    const Scanner& scanner = run.scanner();
    if (!scanner.found().empty()) show(options, scanner, to);
    if (!done) {
      to.err << "fieldcast scan: " << printable(options.port) << ": " << printable(done.error())
             << '\n';
      return ExitCode::kTrouble;
    }
    if (interrupt.raised()) {
      to.err << "fieldcast scan: interrupted; " << scanner.asked() << " questions were asked\n";
      return ExitCode::kInterrupted;
    }
    if (scanner.found().empty()) {
      explain_nothing(options, scanner, is_serial(options), to.err);
      return ExitCode::kNothing;
    }
    explain_broken(scanner, is_serial(options), to.err);
    return options.out.empty() ? ExitCode::kOk
                               : write_configuration(options, *port, scanner, to.err);
  });
}

namespace {

void describe_scan(CommandLine& line, ScanOptions& options) {
  line.text("PORT", options.port, "A serial port (/dev/ttyUSB0, ttyUSB0) or HOST:PORT").required();
  line.texts("--protocol", options.protocols,
             "That devices may speak, in the order of trying (modbus-rtu; HOST:PORT: modbus-tcp)");
  line.number("--baud", options.baud, 50, 4'000'000,
              "Only this rate (the usual ones); HOST:PORT: of the line behind it");
  line.text("--format", options.format, "Only this format: 8N1, 8E1, .. (the usual ones)");
  line.text("--addresses", options.addresses, "Of devices: 1-32, 1,2,10-12 (1-32)");
  line.duration("--timeout", options.timeout, CommandLine::kShortest,
                "To the first byte of a response of each address (200ms); implies --all");
  line.flag("--all", options.all,
            "Request each address at each setting, also on a line that seems silent");
  line.text("--out", options.out, "Write a first configuration there; the file must not exist");
  line.text("--capture", options.capture, kCaptureHelp);
  line.flag("--json", options.json, "JSON lines");
}

}  // namespace

CommandRow scan_command() {
  return command_row("scan", "Find the devices of a line and its settings; needs no bridge",
                     describe_scan, interruptible(scan));
}

}  // namespace fieldcast::cli
