#include "bridge/port/serial_port.hpp"

#include <asm/termbits.h>
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <sys/eventfd.h>
#include <sys/file.h>
#include <sys/ioctl.h>
#include <sys/wait.h>

#include <csignal>
#include <filesystem>

#include "bridge/base/clock.hpp"
#include "bridge/port/serial_line.hpp"
#include "tests/bridge/support/port_probe.hpp"
#include "tests/bridge/support/pty.hpp"

namespace fieldcast::test {
namespace {

using testing::HasSubstr;

struct SerialPortTest : testing::Test {
  SerialPortSpec spec() const {
    SerialPortSpec made;
    made.path = pty.path();
    made.line = {115200, 8, Parity::kNone, 1};
    return made;
  }
  void open(SerialPort& port) {
    port.open(probe);
    ASSERT_TRUE(run_until(io, [this] { return probe.opened == 1 || !probe.closed.empty(); }));
    ASSERT_EQ(probe.opened, 1) << probe.closed.front();
  }

  boost::asio::io_context io{1};
  Pty pty;
  PortProbe probe;
};

TEST_F(SerialPortTest, CarriesEveryByteBothWays) {
  SerialPort port(io, spec());
  open(port);
  Bytes all(256);
  for (std::size_t i = 0; i < all.size(); ++i) all[i] = static_cast<std::uint8_t>(i);
  port.write(all);
  EXPECT_EQ(pty.receive(all.size()), all);
  pty.send(all);
  EXPECT_TRUE(run_until(io, [&] { return probe.received.size() >= all.size(); }));
  EXPECT_EQ(probe.received, all);
}

// The master of a pseudo-terminal sees the rate of its slave.
TEST_F(SerialPortTest, AResponseIsReceivedAtItsOwnRateUntilTheNextRequest) {
  SerialPortSpec slow = spec();
  slow.line.baud = 300;
  SerialPort port(io, slow);
  open(port);
  const auto baud = [&] { return rate_of(pty.master())->baud; };
  const Instant began = steady_now();
  port.write(Bytes{1, 2, 3});
  port.receive_at(9600, 3);
  EXPECT_EQ(baud(), 300u);
  ASSERT_TRUE(run_until(io, [&] { return baud() == 9600; }));
  EXPECT_GE(steady_now() - began, slow.line.characters(3));
  port.write(Bytes{4});
  EXPECT_EQ(baud(), 300u);
  // A change that is due is dropped by the next request, and by a lease.
  port.receive_at(9600, 1);
  port.write(Bytes{5});
  port.receive_at(4800, 1);
  ASSERT_TRUE(run_until(io, [&] { return baud() != 300; }));
  EXPECT_EQ(baud(), 4800u);
  const FileDescriptor leased = port.lease();
  EXPECT_EQ(baud(), 300u);
}

TEST(SerialLine, AFormatIsItsFlagsOfTermios) {
  EXPECT_EQ(format_flags({9600, 8, Parity::kNone, 1}), static_cast<unsigned>(CS8));
  EXPECT_EQ(format_flags({9600, 7, Parity::kEven, 2}),
            static_cast<unsigned>(CS7 | PARENB | CSTOPB));
  EXPECT_EQ(format_flags({9600, 7, Parity::kOdd, 1}), static_cast<unsigned>(CS7 | PARENB | PARODD));
}

// The master of a pseudo-terminal acts as a driver that sets the rate, but knows 8N only.
TEST_F(SerialPortTest, AChangeThatTheDriverSetsOtherwiseLeavesTheLineAsItWas) {
  const int line = pty.master();
  ASSERT_TRUE(change_line(line, {115200, 8, Parity::kNone, 1}));
  EXPECT_FALSE(change_line(line, {9600, 7, Parity::kEven, 2}));
  EXPECT_EQ(rate_of(line), (program::LineSettings{115200, 1}));
}

TEST_F(SerialPortTest, OpeningIsReportedLaterNotImmediately) {
  SerialPort port(io, spec());
  port.open(probe);
  EXPECT_EQ(probe.opened, 0);
  EXPECT_TRUE(run_until(io, [this] { return probe.opened == 1; }));
}

TEST_F(SerialPortTest, PollingDeliversImmediatelyWhatHasArrived) {
  SerialPort port(io, spec());
  open(port);
  port.poll();
  EXPECT_EQ(probe.deliveries, 0);
  pty.send(Bytes{1, 2});
  port.poll();
  EXPECT_EQ(probe.received, (Bytes{1, 2}));
  pty.send(Bytes{3});
  ASSERT_TRUE(run_until(io, [this] { return probe.received.size() == 3; }));
  EXPECT_EQ(probe.received, (Bytes{1, 2, 3}));
}

TEST_F(SerialPortTest, AWaitOfItsThreadDeliversWhatArrivesAndLeavesTheRestToTheIoContext) {
  SerialPort port(io, spec());
  EXPECT_FALSE(port.wait(steady_now(), -1)) << "closed";
  open(port);
  pty.send(Bytes{1, 2});
  EXPECT_TRUE(port.wait(kNever, -1));
  EXPECT_EQ(probe.received, (Bytes{1, 2}));
  const Instant until = steady_now() + std::chrono::milliseconds{5};
  EXPECT_TRUE(port.wait(until, -1));
  EXPECT_GE(steady_now(), until);
  pty.send(Bytes{3});
  while (io.poll_one() > 0) {}
  EXPECT_EQ(probe.deliveries, 1) << "the io_context does not watch the line";
  port.watch();
  ASSERT_TRUE(run_until(io, [this] { return probe.received.size() == 3; }));
}

TEST_F(SerialPortTest, AWaitOfItsThreadEndsWhenItIsWoken) {
  SerialPort port(io, spec());
  open(port);
  const FileDescriptor wake(::eventfd(1, EFD_CLOEXEC));
  EXPECT_TRUE(port.wait(kNever, wake.get()));
  port.write(Bytes(8));
  port.sleep_until(steady_now() + std::chrono::milliseconds{40});
  EXPECT_TRUE(port.wait(kNever, wake.get()));
  EXPECT_EQ(probe.deliveries, 0);
}

TEST_F(SerialPortTest, AWaitOfItsThreadSleepsWhileNoResponseCanBeComplete) {
  SerialPortSpec slow = spec();
  slow.line.baud = 19200;
  SerialPort port(io, slow);
  open(port);
  port.write(Bytes(8));
  const Instant until = steady_now() + std::chrono::milliseconds{30};
  port.sleep_until(until);
  pty.send(Bytes(40));
  EXPECT_TRUE(port.wait(kNever, -1));
  EXPECT_EQ(probe.received.size(), 40u);
  EXPECT_GE(probe.arrived, until);
  EXPECT_EQ(pty.receive(8).size(), 8u);
  pty.send(Bytes{1});
  port.write(Bytes{2});  // drops what was not the response, and the sleep
  pty.send(Bytes{3});
  EXPECT_TRUE(port.wait(kNever, -1));
  EXPECT_EQ(probe.received.back(), 3u);
}

TEST_F(SerialPortTest, ALineThatChangesItsRateIsLeftToTheIoContext) {
  SerialPort port(io, spec());
  open(port);
  port.write(Bytes{1});
  port.receive_at(9600, 1);
  EXPECT_FALSE(port.wait(kNever, -1));
  port.write(Bytes{2});
  EXPECT_TRUE(port.wait(steady_now(), -1));
}

TEST_F(SerialPortTest, ArrivalIsTheInstantOfReading) {
  SerialPort port(io, spec());
  open(port);
  const Instant before = steady_now();
  pty.send(Bytes{1});
  ASSERT_TRUE(run_until(io, [this] { return probe.deliveries == 1; }));
  EXPECT_GE(probe.arrived, before);
  EXPECT_LE(probe.arrived, steady_now());
}

TEST_F(SerialPortTest, MissingDeviceIsReportedInWords) {
  SerialPortSpec missing = spec();
  missing.path = "/dev/fieldcast-no-such-device";
  SerialPort port(io, missing);
  port.open(probe);
  ASSERT_TRUE(run_until(io, [this] { return !probe.closed.empty(); }));
  EXPECT_THAT(probe.closed.front(), HasSubstr("No such file"));
  EXPECT_EQ(probe.causes.front(), Cause::kPortMissing);
  EXPECT_EQ(probe.opened, 0);
}

TEST_F(SerialPortTest, AFileThatIsNotATerminalIsRefused) {
  SerialPortSpec wrong = spec();
  wrong.path = "/dev/null";
  SerialPort port(io, wrong);
  port.open(probe);
  ASSERT_TRUE(run_until(io, [this] { return !probe.closed.empty(); }));
  EXPECT_THAT(probe.closed.front(), HasSubstr("not a serial device"));
}

TEST_F(SerialPortTest, LockedDeviceNamesItsHolder) {
  const int other = ::open(pty.path().c_str(), O_RDWR | O_NOCTTY);
  ASSERT_GE(other, 0);
  ASSERT_EQ(::flock(other, LOCK_EX | LOCK_NB), 0);
  SerialPort port(io, spec());
  port.open(probe);
  ASSERT_TRUE(run_until(io, [this] { return !probe.closed.empty(); }));
  EXPECT_THAT(probe.closed.front(), HasSubstr("in use by"));
  EXPECT_EQ(probe.causes.front(), Cause::kPortInUse);
  EXPECT_THAT(probe.closed.front(), HasSubstr("process " + std::to_string(::getpid())));
  ::close(other);
}

// The kernel truncates names after 15 bytes.
TEST_F(SerialPortTest, AHolderWithALongNameIsNamedWhole) {
  namespace fs = std::filesystem;
  const fs::path program = fs::temp_directory_path() / fmt::format("a-long-named-{}", ::getpid());
  fs::create_symlink("/bin/sleep", program);
  const int other = ::open(pty.path().c_str(), O_RDWR | O_NOCTTY);
  ASSERT_GE(other, 0);
  const pid_t child = ::fork();
  if (child == 0) {
    ::execl(program.c_str(), program.c_str(), "60", nullptr);
    ::_exit(127);
  }
  ::close(other);
  const std::string named = fmt::format("{} (process {})", program.filename().string(), child);
  EXPECT_TRUE(run_until(io, [&] { return port_user(pty.path()) == named; }))
      << port_user(pty.path());
  ::kill(child, SIGKILL);
  ::waitpid(child, nullptr, 0);
  fs::remove(program);
}

TEST_F(SerialPortTest, TheLockEndsWithTheClosing) {
  SerialPort port(io, spec());
  open(port);
  const int other =
      ::open(pty.path().c_str(), O_RDWR | O_NOCTTY);  // allowed for root, despite TIOCEXCL
  if (other >= 0) { EXPECT_NE(::flock(other, LOCK_EX | LOCK_NB), 0); }
  port.close();
  const int later = other >= 0 ? other : ::open(pty.path().c_str(), O_RDWR | O_NOCTTY);
  ASSERT_GE(later, 0);
  EXPECT_EQ(::flock(later, LOCK_EX | LOCK_NB), 0);
  ::close(later);
}

TEST_F(SerialPortTest, UnpluggingIsReportedOnce) {
  SerialPort port(io, spec());
  open(port);
  pty.unplug();
  ASSERT_TRUE(run_until(io, [this] { return !probe.closed.empty(); }));
  port.write(Bytes{1, 2, 3});
  io.restart();
  io.poll();
  EXPECT_EQ(probe.closed.size(), 1u);
}

TEST_F(SerialPortTest, OpensAgainAfterItWasClosed) {
  SerialPort port(io, spec());
  open(port);
  port.close();
  port.open(probe);
  ASSERT_TRUE(run_until(io, [this] { return probe.opened == 2; }));
  port.write(Bytes{7});
  EXPECT_EQ(pty.receive(1), Bytes{7});
}

TEST_F(SerialPortTest, NothingIsReportedAfterClose) {
  SerialPort port(io, spec());
  open(port);
  pty.send(Bytes{1, 2, 3});
  port.close();
  io.restart();
  io.poll();
  EXPECT_EQ(probe.deliveries, 0);
  EXPECT_TRUE(probe.closed.empty());
}

TEST_F(SerialPortTest, StaleBytesAreDroppedBeforeASend) {
  SerialPort port(io, spec());
  open(port);
  pty.send(Bytes{0xEE, 0xEE});  // in the kernel's buffer, not yet delivered
  port.write(Bytes{1});
  EXPECT_EQ(pty.receive(1), Bytes{1});
  pty.send(Bytes{2});
  ASSERT_TRUE(run_until(io, [this] { return !probe.received.empty(); }));
  EXPECT_EQ(probe.received, Bytes{2});
}

TEST_F(SerialPortTest, BytesFromBeforeTheOpeningAreDropped) {
  const int slave = ::open(pty.path().c_str(), O_RDWR | O_NOCTTY);
  ASSERT_GE(slave, 0);
  pty.send(Bytes{0xEE, '\n'});
  SerialPort port(io, spec());
  open(port);
  pty.send(Bytes{5});
  ASSERT_TRUE(run_until(io, [this] { return !probe.received.empty(); }));
  EXPECT_EQ(probe.received, Bytes{5});
  ::close(slave);
}

TEST_F(SerialPortTest, ExpectedCharactersAreDeliveredTogether) {
  SerialPortSpec slow = spec();
  slow.line.baud = 1200;  // 100 characters: 0.83 s
  SerialPort port(io, slow);
  open(port);
  probe.on_bytes = [&] {
    if (probe.deliveries > 1) return;
    port.sleep_until(steady_now() + slow.line.characters(20));
    for (std::uint8_t i = 1; i <= 19; ++i) pty.send(Bytes{i});
  };
  pty.send(Bytes{0});
  ASSERT_TRUE(run_until(io, [this] { return probe.received.size() == 20; }));
  EXPECT_EQ(probe.deliveries, 2);
}

TEST_F(SerialPortTest, ALineThatTakesNothingClosesThePortAtTheLimit) {
  SerialPort port(io, spec());
  open(port);
  const Bytes much(1024, 0x55);
  for (int i = 0; i < 64 && probe.closed.empty(); ++i)
    port.write(much);  // the other end does not read
  ASSERT_TRUE(run_until(io, [this] { return !probe.closed.empty(); }));
  EXPECT_THAT(probe.closed.front(), HasSubstr("takes no bytes"));
}

TEST_F(SerialPortTest, BytesThatTheLineDoesNotTakeImmediatelyFollowInOrder) {
  SerialPort port(io, spec());
  open(port);
  Bytes sent;
  while (sent.size() < 16 * 1024 &&
         probe.closed.empty()) {  // more than the terminal holds, below the write limit
    Bytes part(512);
    for (auto& byte : part)
      byte = static_cast<std::uint8_t>(sent.size() + static_cast<std::size_t>(&byte - part.data()));
    port.write(part);
    append(sent, part);
    int held = 0;
    ASSERT_EQ(::ioctl(pty.master(), FIONREAD, &held), 0);
    if (held + 1024 < static_cast<int>(sent.size())) break;  // some of it waits in the port
  }
  Bytes received;
  ASSERT_TRUE(run_until(io, [&] {
    append(received, pty.take());
    return received.size() >= sent.size() || !probe.closed.empty();
  }));
  EXPECT_EQ(received, sent);
}

TEST_F(SerialPortTest, APseudoTerminalWithoutLineSettingsIsNotAWarning) {
  const int slave = ::open(pty.path().c_str(), O_RDWR | O_NOCTTY);
  ASSERT_GE(slave, 0);
  SerialPortSpec wanted = spec();
  wanted.rs485 = true;
  wanted.line = {12345, 7, Parity::kEven, 2};
  const auto remarks = set_up_line(slave, wanted);
  ASSERT_TRUE(remarks) << remarks.error();
  for (const LineRemark& remark : *remarks) EXPECT_TRUE(remark.harmless) << remark.text;
  ::close(slave);
}

TEST_F(SerialPortTest, TheLineIsRawAndHasItsBaudRate) {
  SerialPortSpec odd = spec();
  odd.line.baud = 250000;
  SerialPort port(io, odd);
  open(port);
  termios2 settings{};
  ASSERT_EQ(::ioctl(pty.master(), TCGETS2, &settings), 0);
  EXPECT_EQ(settings.c_lflag & (ICANON | ECHO | ISIG | IEXTEN), 0u);
  EXPECT_EQ(settings.c_iflag & (IXON | IXOFF | ICRNL | INLCR | ISTRIP), 0u);
  EXPECT_EQ(settings.c_oflag & OPOST, 0u);
  EXPECT_EQ(settings.c_ospeed, 250000u);
}

}  // namespace
}  // namespace fieldcast::test
