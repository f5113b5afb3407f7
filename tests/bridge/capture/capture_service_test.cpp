#include "bridge/capture/capture_service.hpp"

#include <gmock/gmock.h>
#include <sys/socket.h>
#include <sys/time.h>
#include <sys/un.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstring>

#include "bridge/base/file_descriptor.hpp"
#include "bridge/capture/capture_socket.hpp"
#include "core/capture/pcapng.hpp"
#include "core/capture/pcapng_reader.hpp"

namespace fieldcast {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

constexpr std::string_view kBridge = "service-test";

BusSpec one_meter() {
  BusSpec bus;
  bus.name = "line";
  bus.port = SerialPortSpec{"/dev/line"};
  bus.devices.push_back({.name = "meter", .protocol = "modbus-rtu"});
  return bus;
}

// Returns when the service has done all calls before this one, at the latest after 0.5 s.
void settle(CaptureService& service) { service.remove_bus("none"); }

// Only system calls, for a process after fork().
bool connect_to(int socket, const std::string& name) {
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  std::memcpy(address.sun_path + 1, name.data(), name.size());
  const auto size = static_cast<socklen_t>(offsetof(sockaddr_un, sun_path) + 1 + name.size());
  return ::connect(socket, reinterpret_cast<sockaddr*>(&address), size) == 0;
}

class Client {
 public:
  explicit Client(CaptureService& service)
      : socket_(::socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0)) {
    const auto name = capture_socket_name(::geteuid(), std::string(kBridge), ::getpid());
    const timeval limit{10, 0};
    ::setsockopt(socket_.get(), SOL_SOCKET, SO_RCVTIMEO, &limit, sizeof limit);
    for (int i = 0; i < 20 && !connected_; ++i) {
      settle(service);  // it listens
      connected_ = connect_to(socket_.get(), name);
    }
  }
  [[nodiscard]] bool connected() const { return connected_; }
  void say(const std::string& text) { (void)::send(socket_.get(), text.data(), text.size(), 0); }
  void end() { ::shutdown(socket_.get(), SHUT_WR); }
  std::string line() {
    std::string text;
    for (char c{}; ::recv(socket_.get(), &c, 1, 0) == 1 && c != '\n';) text += c;
    return text;
  }
  Bytes rest() {
    Bytes all, part(65536);
    for (;;) {
      const auto got = ::recv(socket_.get(), part.data(), part.size(), 0);
      if (got <= 0) return all;
      all.insert(all.end(), part.begin(), part.begin() + got);
    }
  }

 private:
  FileDescriptor socket_;
  bool connected_ = false;
};

struct Found {
  std::vector<std::string> frames;  // format: "> 01 03 [comment]"
  std::uint64_t dropped = 0;
  bool whole = false;
};
Found read(ByteView bytes) {
  pcapng::Reader reader([&](std::uint8_t* to, std::size_t size) {
    const std::size_t given = std::min(size, bytes.size());
    std::memcpy(to, bytes.data(), given);
    bytes = bytes.subspan(given);
    return given;
  });
  Found found;
  auto packet = reader.next();
  for (; packet && *packet; packet = reader.next()) {
    const auto pdu = parse_upper_pdu((*packet)->data);
    found.frames.push_back(((*packet)->direction == Direction::kSent ? "> " : "< ") +
                           (pdu ? pdu->dissector + " " + to_hex(pdu->frame) : "?") + " [" +
                           (*packet)->comment + "]");
  }
  found.whole = packet.has_value();
  found.dropped = reader.dropped();
  return found;
}

TEST(CaptureServiceTest, AClientGetsTheFramesOfItsBusWhileItListens) {
  CaptureService service{std::string(kBridge)};
  const auto tap = service.add_bus(one_meter());
  Client client(service);
  ASSERT_TRUE(client.connected());
  EXPECT_FALSE(tap->wanted());
  client.say("capture line\n");
  ASSERT_EQ(client.line(), "ok");
  EXPECT_TRUE(tap->wanted());
  tap->put({CaptureRecord::Kind::kSent, {1'000'000}, 0, {1, 3}, "meter: read"});
  tap->put({CaptureRecord::Kind::kReceived, {2'000'000}, 0, {1, 0x83, 2}, {}});
  tap->put({CaptureRecord::Kind::kRemark, {2'000'000}, 0, {}, "meter: refused"});
  service.remove_bus("line");
  const Found found = read(client.rest());
  EXPECT_THAT(found.frames,
              ElementsAre("> mbrtu 01 03 [meter: read]", "< mbrtu 01 83 02 [meter: refused]"));
  EXPECT_TRUE(found.whole);
}

TEST(CaptureServiceTest, AClientThatEndsGetsTheEndOfItsFile) {
  CaptureService service{std::string(kBridge)};
  const auto tap = service.add_bus(one_meter());
  Client client(service);
  client.say("capture line\n");
  ASSERT_EQ(client.line(), "ok");
  client.end();
  EXPECT_TRUE(read(client.rest()).whole);
  for (int i = 0; i < 20 && tap->wanted(); ++i) settle(service);
  EXPECT_FALSE(tap->wanted());
}

TEST(CaptureServiceTest, WhatTheTapDroppedIsSaidInTheFile) {
  CaptureService service{std::string(kBridge)};
  const auto tap = service.add_bus(one_meter());
  Client client(service);
  client.say("capture line\n");
  ASSERT_EQ(client.line(), "ok");
  for (const std::size_t bytes : {std::size_t{100}, CaptureTap::kMaxBytes + 1, std::size_t{100}})
    tap->put({CaptureRecord::Kind::kSent, {1}, 0, Bytes(bytes), {}});
  service.remove_bus("line");
  const Found found = read(client.rest());
  EXPECT_TRUE(found.whole);
  EXPECT_EQ(found.dropped, 1u);
}

TEST(CaptureServiceTest, ARequestForNoBusReturnsThoseThatExist) {
  CaptureService service{std::string(kBridge)};
  (void)service.add_bus(one_meter());
  Client list(service), other(service), nonsense(service);
  list.say("list\n");
  EXPECT_EQ(list.line(), "ok bridge service-test buses line");
  other.say("capture lime\n");
  EXPECT_EQ(other.line(), "no line");
  nonsense.say(std::string(1000, 'x'));
  EXPECT_THAT(nonsense.line(), HasSubstr("refused"));
}

TEST(CaptureServiceTest, AnotherUserIsRefused) {
  if (::geteuid() != 0) GTEST_SKIP() << "only root can be another user";
  CaptureService service{std::string(kBridge)};
  (void)service.add_bus(one_meter());
  Client first(service);  // waits for the listener
  ASSERT_TRUE(first.connected());
  const auto name = capture_socket_name(0, std::string(kBridge), ::getpid());
  const pid_t child = ::fork();
  if (child == 0) {  // a process of another user: system calls only
    const int socket = ::socket(AF_UNIX, SOCK_STREAM, 0);
    char answer[8] = {};
    if (::setuid(65534) != 0 || !connect_to(socket, name) ||
        ::send(socket, "capture line\n", 13, 0) != 13 ||
        ::recv(socket, answer, 7, MSG_WAITALL) != 7)
      ::_exit(1);
    ::_exit(std::strcmp(answer, "refused") == 0 ? 0 : 2);
  }
  int status = 0;
  ASSERT_EQ(::waitpid(child, &status, 0), child);
  EXPECT_EQ(status, 0);
}

// Regression: 16 connections of any user left no place for root.
TEST(CaptureServiceTest, RefusedUsersLeavePlacesFree) {
  if (::geteuid() != 0) GTEST_SKIP() << "only root can be another user";
  CaptureService service{std::string(kBridge)};
  (void)service.add_bus(one_meter());
  ASSERT_TRUE(Client(service).connected());  // it listens
  int ready[2], ended[2];
  ASSERT_EQ(::pipe(ready), 0);
  ASSERT_EQ(::pipe(ended), 0);
  const auto name = capture_socket_name(0, std::string(kBridge), ::getpid());
  const pid_t child = ::fork();
  if (child == 0) {  // a process of another user: system calls only
    ::close(ended[1]);
    bool connected = ::setuid(65534) == 0;
    for (std::size_t i = 0; i < CaptureService::kMaxClients; ++i) {
      connected = connected && connect_to(::socket(AF_UNIX, SOCK_STREAM, 0), name);
    }
    char byte = 0;
    const bool waited = ::write(ready[1], &byte, 1) == 1 && ::read(ended[0], &byte, 1) == 0;
    ::_exit(connected && waited ? 0 : 1);
  }
  ::close(ready[1]);
  ::close(ended[0]);
  char byte = 0;
  EXPECT_EQ(::read(ready[0], &byte, 1), 1);
  Client root(service);
  root.say("list\n");
  EXPECT_EQ(root.line(), "ok bridge service-test buses line");
  ::close(ended[1]);
  ::close(ready[0]);
  int status = 0;
  ASSERT_EQ(::waitpid(child, &status, 0), child);
  EXPECT_EQ(status, 0);
}

TEST(CaptureSocket, ItsNameSaysWhoseItIs) {
  const auto parsed = parse_capture_socket(capture_socket_name(998, "line-7", 4711));
  ASSERT_TRUE(parsed);
  EXPECT_EQ(parsed->user, 998u);
  EXPECT_EQ(parsed->bridge, "line-7");
  EXPECT_EQ(parsed->process, 4711);
  for (const char* other : {"", "fieldcast/capture/", "fieldcast/capture/0/a/1/2",
                            "fieldcast/capture/x/a/1", "dbus-1234", "fieldcast/capture/0//1"})
    EXPECT_FALSE(parse_capture_socket(other)) << other;
}

TEST(CaptureSocket, TheTableOfTheKernelNamesEachOnce) {
  const auto found = capture_sockets(
      "Num       RefCount Protocol Flags    Type St Inode Path\n"
      "0000: 00000002 00000000 00010000 0001 01 504 @fieldcast/capture/0/demo/23788\n"
      "0000: 00000003 00000000 00000000 0001 03 505 @fieldcast/capture/0/demo/23788\n"
      "0000: 00000003 00000000 00000000 0001 03 506 /run/dbus/system_bus_socket\n"
      "0000: 00000003 00000000 00000000 0001 03 507\n"
      "0000: 00000002 00000000 00010000 0001 01 508 @fieldcast/capture/998/line/1\n");
  ASSERT_EQ(found.size(), 2u);
  EXPECT_EQ(found[1].bridge, "line");
}

}  // namespace
}  // namespace fieldcast
