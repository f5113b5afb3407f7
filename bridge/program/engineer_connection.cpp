#include "bridge/program/engineer_connection.hpp"

#include <fmt/format.h>

#include <boost/asio/io_context.hpp>
#include <boost/asio/post.hpp>

#include "bridge/base/clock.hpp"
#include "bridge/log/log.hpp"
#include "bridge/net/byte_stream.hpp"
#include "bridge/port/serial_line.hpp"
#include "bridge/port/stream.hpp"

namespace fieldcast::program {
namespace {

namespace asio = boost::asio;

// Limits for sending the remaining bytes when a side is closed: since the last bytes were sent; in
// total; and in total when the bridge stops.
constexpr Duration kFlushPatience = std::chrono::seconds{5};
constexpr Duration kFlushLongest = std::chrono::minutes{10};
constexpr Duration kFlushAtEnd = std::chrono::seconds{2};
constexpr Duration kFlushCheck = std::chrono::milliseconds{50};

// Watches an end that finishes until it is closed. Keeps no reference to its connection.
class Farewell : public std::enable_shared_from_this<Farewell> {
 public:
  Farewell(asio::io_context& io, std::shared_ptr<RelayEnd> end, Duration longest)
      : timer_(io), end_(std::move(end)), moved_(steady_now()), limit_(moved_ + longest) {}
  void check() {
    if (end_->settle()) return;
    const Instant now = steady_now();
    if (end_->drained()) moved_ = now;
    if (now >= limit_ || now - moved_ >= kFlushPatience) return end_->close();
    timer_.expires_after(kFlushCheck);
    timer_.async_wait([self = shared_from_this()](boost::system::error_code) { self->check(); });
  }

 private:
  asio::steady_timer timer_;
  const std::shared_ptr<RelayEnd> end_;
  Instant moved_;
  const Instant limit_;
};

std::variant<Engineer, LineEngineer> engineer_of(EngineerRules rules, bool by_certificate) {
  rules.by_certificate = by_certificate;
  if (rules.port) return LineEngineer(rules, steady_now());
  return Engineer(rules, steady_now());
}

}  // namespace

EngineerConnection::EngineerConnection(Surroundings& around, std::unique_ptr<ByteStream> stream,
                                       std::string address, const EngineerRules& rules,
                                       LoginProof proof)
    : around_(around),
      address_(std::move(address)),
      proof_(proof),
      only_user_(rules.port ? rules.port->user : std::string()),
      certified_(stream->peer_name()),
      engineer_(engineer_of(rules, certificate_is_login())),
      client_(std::make_shared<RelayEnd>(std::move(stream))),
      timer_(around.io) {}

void EngineerConnection::start() {
  const auto self = shared_from_this();
  client_->start({[self](ByteView bytes) { self->tell(FromClient{bytes}); },
                  [self](const std::string& reason) { self->tell(ClientGone{reason}); },
                  [self](bool room) {
                    if (self->device_) self->device_->pause(!room || self->held_);
                    self->tell(ClientTakes{room});
                  }});
  tell(TimerFired{});  // sets the first timer
  if (certificate_is_login()) check_certificate();
}

bool EngineerConnection::certificate_is_login() const {
  return proof_ == LoginProof::kCertificate ||
         (proof_ == LoginProof::kEither && !certified_.empty());
}

void EngineerConnection::check_certificate() {
  const auto done = response_to(certified_);
  if (certified_.empty()) return done({false, "the certificate has no common name"});
  if (const std::string fault = fault_of_user(certified_); !fault.empty())
    return done({false, fault});
  if (!around_.hooks.certified) return done({true, ""});
  around_.hooks.certified(certified_, host_of(address_), done);
}

// The returned function may be called on any thread.
std::function<void(LoginResponse)> EngineerConnection::response_to(const std::string& user) {
  return [weak = weak_from_this(), &io = around_.io, user](const LoginResponse& response) {
    asio::post(io, [weak, user, response] {
      const auto self = weak.lock();
      if (!self) return;
      if (response.allowed) {
        self->user_ = user;
        self->around_.proven(self);
      }
      self->tell(
          LoginChecked{response.allowed,
                       response.allowed ? "" : fmt::format("user {}: {}", user, response.reason)});
    });
  };
}

std::string EngineerConnection::fault_of_user(const std::string& user) const {
  if (only_user_.empty() || user == only_user_) return {};
  return fmt::format("this port is for {}", only_user_);
}

std::string EngineerConnection::fault_of_password(const std::string& user) const {
  if (std::string fault = fault_of_user(user); !fault.empty()) return fault;
  if (proof_ == LoginProof::kCertificate) return "here the certificate is the login";
  if (!certified_.empty() && user != certified_)
    return fmt::format("the certificate is that of {}", certified_);
  return {};
}

void EngineerConnection::end(const std::string& reason) {
  ended_ = true;
  if (over_) return part();  // its last bytes would be sent for minutes
  tell(Ended{reason});
}

void EngineerConnection::displace() {
  displaced_ = true;
  end("too many silent connections; the oldest is disconnected");
}

void EngineerConnection::tell(const EngineerEvent& event) {
  if (over_) return;
  EngineerActions actions;
  std::visit([&](auto& engineer) { engineer.on_event(event, steady_now(), actions); }, engineer_);
  const auto self = shared_from_this();
  for (const EngineerAction& action : actions) {
    std::visit([&](const auto& what) { execute(what); }, action);
  }
}

void EngineerConnection::execute(const ToClient& what) { client_->send(what.bytes); }

void EngineerConnection::execute(const ToDevice& what) {
  if (!device_) return;
  capture(Direction::kSent, what.bytes);
  lease_->last_request.on_sent(what.bytes, read_clocks().to_utc(steady_now()));
  device_->send(what.bytes);
}

void EngineerConnection::execute(const CheckLogin& what) {
  const auto done = response_to(what.user);
  if (const std::string fault = fault_of_password(what.user); !fault.empty())
    return done({false, fault});
  if (!around_.hooks.login) return done({false, "this bridge has no users"});
  around_.hooks.login(what.user, Secret(what.password), host_of(address_), done);
}

void EngineerConnection::execute(const TakeDevice& what) {
  number_ = what.number;
  lost_.reset();
  const auto weak = weak_from_this();
  lease_ = around_.devices->take(what.number, who(),
                                 {[weak](FileDescriptor line) {
                                    if (const auto self = weak.lock())
                                      self->granted(std::move(line));
                                  },
                                  [weak](const Refusal& refusal) {
                                    if (const auto self = weak.lock())
                                      self->tell(DeviceRefused{refusal.why, refusal.reason});
                                  },
                                  [weak](const std::string& reason) {
                                    const auto self = weak.lock();
                                    if (!self) return;
                                    self->lost_ = reason;
                                    self->tell(DeviceLost{reason});
                                  }});
}

void EngineerConnection::execute(const ListDevices&) {
  number_.clear();  // of an earlier request
  asio::post(around_.io, [weak = weak_from_this()] {
    const auto self = weak.lock();
    if (self) self->tell(DevicesListed{self->around_.devices->devices()});
  });
}

void EngineerConnection::granted(FileDescriptor line) {
  line_ = line.get();
  tune_socket(line_, kTunnelPatience);  // no effect on a serial line
  auto stream = descriptor_stream(around_.io, std::move(line));
  if (!stream) {
    lost_ = "its line is of no use";
    around_.devices->give_back(lease_, lost_);
    return tell(DeviceRefused{Reply::kNotOnline, *lost_});
  }
  const auto self = shared_from_this();
  device_ = std::make_shared<RelayEnd>(std::move(stream));
  since_ = read_clocks().to_utc(steady_now());
  reported_bytes_ = 0;
  errors_ = {};
  (void)line_errors(line_, errors_);
  around_.proven(self);
  tell(DeviceGiven{lease_->format});
  if (!device_) return;
  device_->start({[self](ByteView bytes) {
                    self->capture(Direction::kReceived, bytes);
                    self->lease_->last_request.on_received();
                    self->tell(FromDevice{bytes});
                  },
                  [self](const std::string& reason) {
                    self->lost_ = reason;
                    self->tell(DeviceLost{reason});
                  },
                  [self](bool room) {
                    self->client_->pause(!room);
                    self->tell(DeviceTakes{room});
                  }});
  report(ProgramSessionState::kOpen);
}

void EngineerConnection::capture(Direction direction, ByteView bytes) const {
  if (!lease_->tap || !lease_->tap->sessions_wanted()) return;
  const bool sent = direction == Direction::kSent;
  lease_->tap->put({.kind = sent ? CaptureRecord::Kind::kSent : CaptureRecord::Kind::kReceived,
                    .at = read_clocks().to_utc(steady_now()),
                    .device = lease_->index,
                    .bytes = Bytes(bytes.begin(), bytes.end()),
                    .text = sent ? std::string(kSessionComment) + who() : "",
                    .session = true});
}

void EngineerConnection::execute(const SetLine& what) {
  if (!device_) return;
  if (!lease_->settings && !lease_->at_server)
    return log_counted(LogLevel::kInfo, "program", "changes of lines",
                       fmt::format("{}/{}: behind a network, its line keeps its settings",
                                   lease_->bus, lease_->device));
  LineFormat line = lease_->settings.value_or(lease_->format);
  if (what.settings.baud != 0) line.baud = what.settings.baud;
  line.stop_bits = what.settings.stop_bits;
  if (what.settings.data_bits != 0) {
    line.data_bits = what.settings.data_bits;
    line.parity = what.settings.parity;
  }
  if (!lease_->at_server) return void(set_line(line));
  for (const telnet::Kind kind : telnet::kSettings) {
    const std::uint32_t value = value_of(kind, line);
    if (value != value_of(kind, lease_->format)) change_at_server({kind, value});
  }
}

bool EngineerConnection::set_line(const LineFormat& line) {
  const std::string target = lease_->bus + '/' + lease_->device;
  if (const auto changed = change_line(line_, line); !changed) {
    log_counted(LogLevel::kWarning, "program", "lines not changed",
                fmt::format("{}: line not set to {}: {}", target, to_text(line), changed.error()));
    audit(fmt::format("line not set to {}: {}", to_text(line), changed.error()));
    return false;
  }
  log_counted(LogLevel::kInfo, "program", "changes of lines",
              fmt::format("{}: line set to {}", target, to_text(line)));
  lease_->format = line;
  return true;
}

void EngineerConnection::execute(const ChangeLine& what) {
  if (device_ && lease_->at_server) return change_at_server(what.change);
  tell(LineChanged{what.change, device_ && changed(what.change)});
}

// Behind a network a line keeps its settings, and has no modem lines.
bool EngineerConnection::changed(const telnet::LineChange& change) {
  const bool serial = lease_->settings.has_value();
  const auto control = static_cast<telnet::Control>(change.value);
  LineFormat line = lease_->format;
  switch (change.kind) {
    case telnet::Kind::kControl:
      return serial ? set_control(line_, control)
                    : control >= telnet::Control::kDtrOn || control == telnet::Control::kNoFlow;
    case telnet::Kind::kPurge:
      if (serial) purge(line_, change.value);
      return true;
    default:
      if (!set_value(line, change.kind, change.value)) return false;
      return line == lease_->format || (serial && set_line(line));
  }
}

// The response to the client waits for that of the server.
void EngineerConnection::change_at_server(const telnet::LineChange& change) {
  auto done = [weak = weak_from_this(), &io = around_.io,
               change](std::optional<std::uint32_t> value) {
    asio::post(io, [weak, change, value] {
      const auto self = weak.lock();
      if (!self || !self->device_) return;
      // Changes nothing for a control or a purge.
      if (value) (void)set_value(self->lease_->format, change.kind, *value);
      self->tell(LineChanged{{change.kind, value.value_or(change.value)}, value.has_value()});
    });
  };
  lease_->runner->change_line(lease_->bus_lease, change, std::move(done));
}

void EngineerConnection::execute(const HoldDevice& what) {
  held_ = what.hold;
  if (device_) device_->pause(held_ || client_->crowded());
}

void EngineerConnection::execute(const FreeDevice&) {
  if (!lease_) return;
  client_->pause(false);
  if (!device_) return around_.devices->give_back(lease_, std::nullopt);
  report_request();
  report(ProgramSessionState::kClosed);
  const auto device = std::exchange(device_, nullptr);
  line_ = -1;
  // The registry keeps the device until the remaining bytes are sent, or cannot be sent any more.
  lease_->leaving = device;
  device->finish(RelayEnd::Until::kLeft, [lease = lease_, lost = lost_, devices = around_.devices] {
    devices->give_back(lease, lost);
  });
  if (lost_) return device->close();
  std::make_shared<Farewell>(around_.io, device, ended_ ? kFlushAtEnd : kFlushLongest)->check();
}

void EngineerConnection::execute(const HangUp&) {
  over_ = true;
  timer_.cancel();
  const auto self = shared_from_this();
  client_->finish(RelayEnd::Until::kTaken,
                  [self] { asio::post(self->around_.io, [self] { self->around_.over(self); }); });
  part();
}

void EngineerConnection::part() {
  std::make_shared<Farewell>(around_.io, client_, ended_ ? kFlushAtEnd : kFlushLongest)->check();
}

void EngineerConnection::execute(const SetTimer& what) {
  timer_.cancel();
  if (what.at == kNever) return;
  timer_.expires_at(std::chrono::steady_clock::time_point{what.at.time_since_epoch()});
  timer_.async_wait([weak = weak_from_this()](boost::system::error_code cancelled) {
    const auto self = weak.lock();
    if (!cancelled && self) self->tell(TimerFired{});
  });
}

void EngineerConnection::execute(const Remark& what) {
  if (displaced_) return;
  const std::string target = number_.empty() ? ""
                             : lease_        ? lease_->bus + '/' + lease_->device
                                             : number_;
  const std::string text =
      fmt::format("{}{}: {}", who(), target.empty() ? "" : " at " + target, what.text);
  switch (what.kind) {
    case Remark::Kind::kLogin: return audit("logged in");
    case Remark::Kind::kListed:
      log_counted(LogLevel::kInfo, "program", "lists of devices", text);
      return audit(what.text);
    case Remark::Kind::kPaired:
      log_counted(LogLevel::kInfo, "program", "pairings", text + ", paired");
      return audit("paired, " + what.text);
    case Remark::Kind::kEnded:
      log_counted(LogLevel::kInfo, "program", "ends of pairings", text);
      return audit("ended: " + what.text);
    case Remark::Kind::kLoginFailed:
      log_counted(LogLevel::kWarning, "program", "logins refused", text);
      return audit("login refused: " + what.text);
    case Remark::Kind::kRefused:
      log_counted(LogLevel::kWarning, "program", "engineers refused", text);
      return audit("refused: " + what.text);
    case Remark::Kind::kDropped:
      log_counted(LogLevel::kWarning, "program", "connections dropped", text);
      return audit("dropped: " + what.text);
  }
}

void EngineerConnection::audit(const std::string& result) const {
  if (!around_.hooks.audit) return;
  const std::string target = number_.empty() ? ""
                             : lease_        ? lease_->bus + '/' + lease_->device
                                             : number_;
  around_.hooks.audit({who(), target, bytes_to_device(), bytes_from_device(), result});
}

std::uint64_t EngineerConnection::bytes_to_device() const {
  return std::visit([](const auto& engineer) { return engineer.bytes_to_device(); }, engineer_);
}
std::uint64_t EngineerConnection::bytes_from_device() const {
  return std::visit([](const auto& engineer) { return engineer.bytes_from_device(); }, engineer_);
}

void EngineerConnection::tick() {
  if (client_->crowded() && client_->drained()) tell(ClientDrains{});
  if (device_ && device_->crowded() && device_->drained()) tell(DeviceDrains{});
  if (device_ && !peer_responds(line_)) {
    lost_ = "it no longer responds";
    return tell(DeviceLost{*lost_});
  }
  if (device_) tell(LineState{modem_state(line_), line_errors(line_, errors_)});
  const std::uint64_t bytes = bytes_to_device() + bytes_from_device();
  if (device_ && bytes != reported_bytes_) report(ProgramSessionState::kOpen);
  if (device_) report_request();
}

void EngineerConnection::report(ProgramSessionState state) {
  reported_bytes_ = bytes_to_device() + bytes_from_device();
  if (!around_.hooks.report) return;
  around_.hooks.report(
      {lease_->bus, lease_->device, state, who(), bytes_to_device(), bytes_from_device(), since_});
}

void EngineerConnection::report_request() {
  auto last = lease_->last_request.take();
  if (!last || !around_.hooks.requested) return;
  around_.hooks.requested({lease_->bus, lease_->device, std::move(last->text), last->sent_at});
}

std::string EngineerConnection::who() const {
  return user_.empty() ? address_ : fmt::format("{} ({})", user_, address_);
}

}  // namespace fieldcast::program
