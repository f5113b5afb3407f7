#include <gmock/gmock.h>

#include <boost/asio/ip/udp.hpp>

#include "bridge/port/stream_port.hpp"
#include "tests/bridge/support/port_probe.hpp"

namespace fieldcast::test {
namespace {

namespace asio = boost::asio;
using asio::ip::udp;
using testing::HasSubstr;

udp::endpoint free_place() { return {asio::ip::address_v4::loopback(), 0}; }

struct UdpPortTest : testing::Test {
  TcpPortSpec spec() const {
    TcpPortSpec made;
    made.host = "127.0.0.1";
    made.port = device.local_endpoint().port();
    made.datagrams = true;
    return made;
  }
  void open(TcpPort& port) {
    port.open(probe);
    ASSERT_TRUE(run_until(io, [this] { return probe.opened == 1; }));
  }
  Bytes receive() {
    Bytes datagram(100);
    datagram.resize(device.receive_from(asio::buffer(datagram), master));
    return datagram;
  }

  asio::io_context io{1};
  udp::socket device{io, free_place()};
  udp::endpoint master;
  PortProbe probe;
};

TEST_F(UdpPortTest, ARequestIsADatagram) {
  TcpPort port(io, spec());
  open(port);
  port.write(Bytes{0, 1, 2, 0xFF});
  port.write_more(Bytes{3});
  EXPECT_EQ(receive(), (Bytes{0, 1, 2, 0xFF}));
  EXPECT_EQ(receive(), Bytes{3});
  device.send_to(asio::buffer(Bytes{9, 8}), master);
  ASSERT_TRUE(run_until(io, [&] { return probe.received.size() == 2; }));
  EXPECT_EQ(probe.received, (Bytes{9, 8}));
}

TEST_F(UdpPortTest, AnEmptyDatagramEndsNothing) {
  TcpPort port(io, spec());
  open(port);
  port.write(Bytes{1});
  receive();
  device.send_to(asio::buffer(Bytes{}), master);
  device.send_to(asio::buffer(Bytes{7}), master);
  ASSERT_TRUE(run_until(io, [&] { return !probe.received.empty(); }));
  EXPECT_EQ(probe.received, Bytes{7});
  EXPECT_THAT(probe.closed, testing::IsEmpty());
}

TEST_F(UdpPortTest, AllDatagramsBeforeARequestAreDropped) {
  TcpPort port(io, spec());
  open(port);
  port.write(Bytes{1});
  receive();
  for (const auto& late : {Bytes{5}, Bytes{6}}) device.send_to(asio::buffer(late), master);
  port.write(Bytes{2});
  receive();
  device.send_to(asio::buffer(Bytes{7}), master);
  ASSERT_TRUE(run_until(io, [&] { return !probe.received.empty(); }));
  EXPECT_EQ(probe.received, Bytes{7});
}

TEST_F(UdpPortTest, ADatagramOfAnotherSenderIsNotReceived) {
  TcpPort port(io, spec());
  open(port);
  port.write(Bytes{1});
  receive();
  udp::socket(io, free_place()).send_to(asio::buffer(Bytes{6}), master);
  device.send_to(asio::buffer(Bytes{7}), master);
  ASSERT_TRUE(run_until(io, [&] { return !probe.received.empty(); }));
  EXPECT_EQ(probe.received, Bytes{7});
}

TEST_F(UdpPortTest, ARefusalByIcmpClosesThePort) {
  TcpPort port(io, spec());
  device.close();
  open(port);
  port.write(Bytes{1});
  ASSERT_TRUE(run_until(io, [this] { return !probe.closed.empty(); }));
  EXPECT_THAT(probe.closed.front(), HasSubstr("no program receives datagrams there"));
}

}  // namespace
}  // namespace fieldcast::test
