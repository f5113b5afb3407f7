// One engineer's client: its stream, the device leased to it, and the pure Engineer, whose actions
// it executes. Runs on the server's io thread; the server owns it until it has ended.
#pragma once

#include <boost/asio/steady_timer.hpp>
#include <memory>
#include <string>

#include "bridge/capture/bus_capture.hpp"
#include "bridge/port/serial_line.hpp"
#include "bridge/program/device_registry.hpp"
#include "bridge/program/module/hooks.hpp"
#include "bridge/program/module/relay_end.hpp"
#include "core/model/program_spec.hpp"
#include "core/program/engineer.hpp"
#include "core/program/line_engineer.hpp"

namespace fieldcast::program {

class EngineerConnection : public std::enable_shared_from_this<EngineerConnection> {
 public:
  // What it needs of its server, which must outlive it.
  struct Surroundings {
    boost::asio::io_context& io;
    std::shared_ptr<DeviceRegistry> devices;
    const Hooks& hooks;
    std::function<void(const std::shared_ptr<EngineerConnection>&)> over;
    // Called when the client has logged in or was given a device.
    std::function<void(const std::shared_ptr<EngineerConnection>&)> proven;
  };

  EngineerConnection(Surroundings& around, std::unique_ptr<ByteStream> stream, std::string address,
                     const EngineerRules& rules, LoginProof proof = LoginProof::kPassword);

  void start();
  [[nodiscard]] bool programs(const std::string& bus, const std::string& device) const {
    return device_ && lease_->bus == bus && lease_->device == device;
  }
  // Called when the bridge stops or an operator ends the session: notifies the client and frees the
  // device.
  void end(const std::string& reason);
  // Ends an unauthenticated connection in favour of new ones, without a line in log and audit.
  void displace();
  // Called once a second: reports the bytes of an active session, and checks whether queues drain.
  void tick();

 private:
  [[nodiscard]] bool certificate_is_login() const;
  void check_certificate();
  // Returns the callback for the verdict on this user.
  [[nodiscard]] std::function<void(LoginResponse)> response_to(const std::string& user);
  // Reason why this user may not log in here; empty if the user may.
  [[nodiscard]] std::string fault_of_user(const std::string& user) const;
  // Reason why a password of this user is rejected without a check; empty if it is checked.
  [[nodiscard]] std::string fault_of_password(const std::string& user) const;
  // Sends the client its last bytes, for a limited time.
  void part();
  void tell(const EngineerEvent& event);
  void execute(const ToClient& what);
  void execute(const ToDevice& what);
  void execute(const CheckLogin& what);
  void execute(const TakeDevice& what);
  void execute(const ListDevices& what);
  void execute(const SetLine& what);
  void execute(const ChangeLine& what);
  void execute(const HoldDevice& what);
  void execute(const FreeDevice& what);
  void execute(const HangUp& what);
  void execute(const SetTimer& what);
  void execute(const Remark& what);
  void granted(FileDescriptor line);
  // Returns false, with a line in log and audit, if the driver refuses.
  bool set_line(const LineFormat& line);
  [[nodiscard]] bool changed(const telnet::LineChange& change);
  void change_at_server(const telnet::LineChange& change);
  // For a capture of the bus.
  void capture(Direction direction, ByteView bytes) const;
  [[nodiscard]] std::uint64_t bytes_to_device() const;
  [[nodiscard]] std::uint64_t bytes_from_device() const;
  void report(ProgramSessionState state);
  void report_request();
  void audit(const std::string& result) const;
  [[nodiscard]] std::string who() const;

  Surroundings& around_;
  const std::string address_;
  const LoginProof proof_;
  const std::string only_user_;  // of a port for one user
  const std::string certified_;  // user named by the client's certificate
  std::string user_;
  std::variant<Engineer, LineEngineer> engineer_;
  std::shared_ptr<RelayEnd> client_, device_;
  std::shared_ptr<DeviceLease> lease_;
  int line_ = -1;                    // of the device, while device_ exists: for its settings
  std::optional<std::string> lost_;  // reason why the device's line ended
  boost::asio::steady_timer timer_;
  std::string number_;  // the last requested device number
  UtcTime since_{};
  std::uint64_t reported_bytes_ = 0;
  LineErrors errors_;  // already reported
  bool held_ = false;  // the client has suspended data
  bool over_ = false;
  bool ended_ = false;      // by the bridge
  bool displaced_ = false;  // ended by the bridge, without a line in the log
};

}  // namespace fieldcast::program
