#include <fcntl.h>

#include "bridge/port/serial_line.hpp"
#include "tools/program-port/local_port.hpp"
#include "tools/sim/port/pty_port.hpp"

namespace fieldcast::port {
namespace {

// A rate that no program uses, so that every change is detected, even to the default 38400.
constexpr std::uint32_t kNobodysRate = 38401;

class PseudoTerminal final : public LocalPort {
 public:
  explicit PseudoTerminal(sim::PtyPort pty) : pty_(std::move(pty)) {
    (void)change_line(pty_.fd(), {kNobodysRate, 8, Parity::kNone, 1});
  }
  std::unique_ptr<ByteStream> stream(boost::asio::io_context& io) override {
    return descriptor_stream(io, FileDescriptor(::fcntl(pty_.fd(), F_DUPFD_CLOEXEC, 0)));
  }
  std::optional<program::LineSettings> settings() const override { return rate_of(pty_.fd()); }

 private:
  sim::PtyPort pty_;
};

}  // namespace

const LocalPortOption kLocalPortOption{
    "--link",
    "where the virtual port appears, such as /tmp/plc; never over a file that is not ours",
    "the programming software may open the port"};

tl::expected<std::unique_ptr<LocalPort>, std::string> open_local_port(
    const std::string& name, const program::LineSettings&) {
  auto pty = sim::PtyPort::open(name);
  if (!pty) return tl::make_unexpected(pty.error());
  return std::make_unique<PseudoTerminal>(*std::move(pty));
}

}  // namespace fieldcast::port
