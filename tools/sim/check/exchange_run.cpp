#include "tools/sim/check/exchange_run.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <stdexcept>

#include "core/model/bus_spec.hpp"
#include "core/protocol/families/registry.hpp"

namespace fieldcast::sim {

namespace {

std::string text_of(const ProtocolVariant& variant) {
  std::string text;
  for (const auto& [name, value] : variant.options) {
    text += text.empty() ? "" : ", ";
    text.append(name).append(": ").append(value);
  }
  return text;
}

DeviceSpec device_at(std::uint16_t address) {
  DeviceSpec device;
  device.name = "device";
  device.link.address = address;
  device.timeout = std::chrono::seconds{1};
  device.retries = 0;
  return device;
}

PortSpec serial() {
  SerialPortSpec port;
  port.line = LineFormat{115200, 8, Parity::kEven, 1};
  return port;
}

bool has_check(const declared::Frame& frame) {
  return std::ranges::any_of(
      frame.fields, [](const auto& field) { return field.kind == declared::FieldKind::kChecksum; });
}

}  // namespace

std::unique_ptr<Protocol> Subject::protocol() const {
  DeviceSpec spec = device;
  auto made = make_protocol(spec, line());
  return made ? std::move(*made) : nullptr;
}

std::optional<Subject> Subject::neighbour() const {
  Subject other = *this;
  const ProtocolEntry* entry = find_protocol(device.protocol);
  if (entry != nullptr && entry->one_device) return std::nullopt;
  const auto made = protocol();
  const auto [lowest, highest] =
      std::pair(made->traits().lowest_address, made->traits().highest_address);
  if (lowest == highest) return std::nullopt;
  other.device.link.long_address.clear();
  other.device.link.address = static_cast<std::uint16_t>(
      device.link.address < highest ? device.link.address + 1 : device.link.address - 1);
  return other;
}

std::vector<Subject> subjects_of(std::string_view protocol) {
  std::vector<Subject> subjects;
  const ProtocolEntry* entry = find_protocol(protocol);
  if (entry == nullptr) return subjects;
  for (const ProtocolVariant& variant : entry->variants) {
    Subject subject{.variant = text_of(variant),
                    .device = device_at(7),
                    .port = serial(),
                    .addresses = variant.addresses};
    subject.device.protocol = protocol;
    subject.device.link = link_of(variant, subject.device.link.address);
    if (entry->network_only) {
      const std::string datagrams(entry->datagram_option);
      subject.port = TcpPortSpec{.datagrams = subject.device.link.options.contains(datagrams)};
    }
    subject.checked = !entry->carrier_checks;
    subjects.push_back(std::move(subject));
  }
  return subjects;
}

std::vector<Subject> subjects_of(const declared::SharedDeclaration& declaration) {
  const declared::Declaration& value = *declaration.value;
  Subject subject{"",
                  device_at(static_cast<std::uint16_t>(
                      std::clamp<std::uint64_t>(7, value.lowest_address, value.highest_address))),
                  serial()};
  subject.device.protocol = value.name;
  subject.device.declaration = declaration;
  subject.checked = std::ranges::all_of(value.operations,
                                        [](const auto& each) {
                                          return has_check(each.response) &&
                                                 std::ranges::all_of(each.others, has_check);
                                        }) &&
                    std::ranges::all_of(value.refusals, has_check);
  std::size_t forms = 1;
  for (const declared::Operation& operation : value.operations)
    forms = std::max(forms, operation.others.size() + 1);
  std::vector<Subject> subjects;
  for (; subject.form < forms; ++subject.form) {
    if (forms > 1) subject.variant = fmt::format("form {}", subject.form + 1);
    subjects.push_back(subject);
  }
  return subjects;
}

namespace {

using namespace std::chrono_literals;

constexpr Duration kTimeout = 1s, kGapAllowance = 20ms, kPiece = 1ms;
constexpr int kMostSteps = 100'000;      // of one exchange: more is a hang
constexpr std::size_t kMostRounds = 64;  // more is an endless exchange

BusSpec bus_of(const Subject& subject) {
  BusSpec bus;
  bus.name = "check";
  bus.port = subject.port;
  bus.devices = {subject.device};
  return bus;
}

RunOutcome finish(ExchangeDriver& driver, ExchangeDriver::Outcome how, RunOutcome outcome) {
  outcome.done = how == ExchangeDriver::Outcome::kDone;
  outcome.cause = how == ExchangeDriver::Outcome::kWaiting || how == ExchangeDriver::Outcome::kSend
                      ? Cause::kOverlong
                      : driver.cause();
  outcome.code = driver.device_code();
  if (outcome.done) outcome.reply = driver.exchange().reply();
  return outcome;
}

bool ended(ExchangeDriver::Outcome outcome) {
  return outcome == ExchangeDriver::Outcome::kDone || outcome == ExchangeDriver::Outcome::kFailed;
}

}  // namespace

bool RunOutcome::same_as(const RunOutcome& other) const {
  return done == other.done && cause == other.cause && code == other.code &&
         std::ranges::equal(reply, other.reply, [](const RangeReply& a, const RangeReply& b) {
           return a.cause == b.cause && a.device_code == b.device_code && a.items == b.items &&
                  a.absent == b.absent;
         });
}

std::string RunOutcome::text() const {
  if (!done)
    return std::string(to_text(cause)) + (code != 0 ? fmt::format(" (code {})", code) : "");
  std::string text = "taken:";
  for (const RangeReply& range : reply) {
    text += range.cause == Cause::kNone ? fmt::format(" [{}]", to_hex(range.items))
                                        : fmt::format(" [{}]", to_text(range.cause));
  }
  return text;
}

std::string frames(const std::vector<Bytes>& all) {
  std::string text;
  for (const Bytes& each : all) text += (text.empty() ? "" : " | ") + to_hex(each);
  return text;
}

LiveDevice::LiveDevice(const Subject& subject, const BusFaults& faults)
    : line_format_(subject.line()) {
  BusFaults all = faults;
  all.devices[subject.device.name].form = subject.form;
  auto bus = SimBus::make(bus_of(subject), all, 1, now_);
  if (!bus) throw std::runtime_error(bus.error());
  bus_ = std::move(*bus);
  line_ = bus_->open_line();
}

RunOutcome LiveDevice::run(std::unique_ptr<Exchange> exchange) {
  ExchangeDriver driver(line_format_, kGapAllowance, Echo::kAbsent);
  RunOutcome outcome;
  Bytes out;
  auto how = ExchangeDriver::Outcome::kWaiting;
  const auto send = [&] {
    line_->receive(out, now_);
    outcome.sent.push_back(out);
    outcome.responses.emplace_back();
    how = ExchangeDriver::Outcome::kWaiting;
  };
  driver.begin(std::move(exchange), kTimeout, EqualBytes::kEcho, now_, out);
  send();
  for (int step = 0; !ended(how) && step < kMostSteps && outcome.sent.size() <= kMostRounds;
       ++step) {
    now_ = std::max(now_, std::min(line_->next_due(), driver.deadline()));
    Bytes received;
    line_->advance(now_, received);
    if (!received.empty()) {
      append(outcome.responses.back(), received);
      how = driver.on_bytes(received, now_, out);
    } else if (now_ >= driver.deadline()) {
      how = driver.on_timer(now_, out);
    }
    if (how == ExchangeDriver::Outcome::kSend) send();
  }
  if (ended(how) && !out.empty()) line_->receive(out, now_);  // a confirmation
  now_ += 200ms;  // the line becomes idle, as between two requests
  Bytes late;
  line_->advance(now_, late);
  return finish(driver, how, std::move(outcome));
}

RunOutcome replay(std::unique_ptr<Exchange> exchange, const LineFormat& line,
                  std::span<const Bytes> responses, std::span<const std::size_t> cuts) {
  ExchangeDriver driver(line, kGapAllowance, Echo::kAbsent);
  RunOutcome outcome;
  Bytes out;
  Instant now{};
  driver.begin(std::move(exchange), kTimeout, EqualBytes::kEcho, now, out);
  outcome.sent.push_back(out);
  auto how = ExchangeDriver::Outcome::kWaiting;
  for (int step = 0; !ended(how) && step < kMostSteps && outcome.sent.size() <= kMostRounds;
       ++step) {
    const std::size_t round = outcome.sent.size();
    const Bytes none;
    const Bytes& response = round <= responses.size() ? responses[round - 1] : none;
    now = std::max(now, driver.sent_until());
    how = ExchangeDriver::Outcome::kWaiting;
    for (std::size_t from = 0, piece = 0;
         from < response.size() && how == ExchangeDriver::Outcome::kWaiting; ++piece) {
      const std::size_t to =
          piece < cuts.size() ? std::min(cuts[piece], response.size()) : response.size();
      if (to <= from) continue;
      now += kPiece;
      how = driver.on_bytes(ByteView(response).subspan(from, to - from), now, out);
      from = to;
    }
    while (how == ExchangeDriver::Outcome::kWaiting && step++ < kMostSteps) {
      now = std::max(now, driver.deadline());
      how = driver.on_timer(now, out);
    }
    if (how == ExchangeDriver::Outcome::kSend) outcome.sent.push_back(out);
  }
  return finish(driver, how, std::move(outcome));
}

}  // namespace fieldcast::sim
