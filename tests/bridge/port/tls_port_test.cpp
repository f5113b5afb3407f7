// TLS of a port, against the TLS server of the bridge and against servers that are none.
#include <gmock/gmock.h>

#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/read.hpp>
#include <boost/asio/write.hpp>
#include <random>

#include "bridge/net/tls.hpp"
#include "bridge/net/tls_engine.hpp"
#include "bridge/port/port.hpp"
#include "tests/bridge/support/certificates.hpp"
#include "tests/bridge/support/port_probe.hpp"

namespace fieldcast::test {
namespace {

namespace asio = boost::asio;
using asio::ip::tcp;
using namespace std::chrono_literals;
using testing::AllOf;
using testing::HasSubstr;

using Spec = std::variant_alternative_t<1, PortSpec>;  // of a port over TCP

struct TlsPortTest : testing::Test {
  static void SetUpTestSuite() {
    files = std::make_unique<Certificates>();
    files->issue("plc", "plc");
    files->issue("bridge", "bridge");
    files->make_own("alone", "alone");
  }
  static void TearDownTestSuite() { files.reset(); }

  static TlsSpec own(const std::string& name, const std::string& authority) {
    return {files->file(name + ".pem"),
            files->file(name + ".key"),
            files->file(authority + ".pem"),
            {}};
  }
  Spec spec(const std::string& client = "bridge", const std::string& authority = "ca") {
    Spec made;
    made.host = "127.0.0.1";
    made.port = acceptor.local_endpoint().port();
    made.tls = own(client, authority);
    return made;
  }
  // Accepts one connection and shakes hands.
  void serve(const TlsSpec& certificate) {
    server = *TlsServer::make(certificate);
    acceptor.async_accept([this](boost::system::error_code, tcp::socket socket) {
      (void)server->shake_hands(std::move(socket), 5s, [this](TlsResult result) {
        if (result) stream = std::move(*result);
      });
    });
  }
  // Accepts one connection without TLS and sends these bytes.
  void accept(const std::string& bytes) {
    acceptor.async_accept(
        peer, [this, bytes](boost::system::error_code) { asio::write(peer, asio::buffer(bytes)); });
  }
  void connect(Port& port) {
    serve(own("plc", "ca"));
    port.open(probe);
    ASSERT_TRUE(run_until(io, [this] { return probe.opened == 1 && stream; }));
  }
  std::string refusal(const Spec& tried) {
    const auto made = make_port(io, tried);
    Port& port = *made;
    port.open(probe);
    if (!run_until(io, [this] { return !probe.closed.empty(); })) return "no refusal";
    EXPECT_EQ(probe.causes.front(),
              probe.opened == 0 ? Cause::kPortUnreachable : Cause::kPortClosed);
    return probe.closed.front();
  }
  void send(const Bytes& bytes) {
    bool sent = false;
    stream->write_some(asio::buffer(bytes),
                       [&](boost::system::error_code, std::size_t) { sent = true; });
    ASSERT_TRUE(run_until(io, [&] { return sent; }));
  }
  Bytes receive() {
    Bytes bytes(100);
    std::size_t size = 0;
    stream->read_some(asio::buffer(bytes),
                      [&](boost::system::error_code, std::size_t count) { size = count; });
    EXPECT_TRUE(run_until(io, [&] { return size != 0; }));
    bytes.resize(size);
    return bytes;
  }

  static std::unique_ptr<Certificates> files;
  asio::io_context io{1};
  tcp::acceptor acceptor{io, tcp::endpoint{asio::ip::address_v4::loopback(), 0}};
  tcp::socket peer{io};
  std::unique_ptr<TlsServer> server;
  std::unique_ptr<ByteStream> stream;
  PortProbe probe;
};
std::unique_ptr<Certificates> TlsPortTest::files;

TEST_F(TlsPortTest, CarriesBytesBothWays) {
  const auto made = make_port(io, spec());
  Port& port = *made;
  connect(port);
  EXPECT_EQ(stream->peer_name(), "bridge");
  port.write(Bytes{0, 1, 2, 0xFF});
  EXPECT_EQ(receive(), (Bytes{0, 1, 2, 0xFF}));
  Bytes longest(10'000, 7);  // more than a read of the socket
  longest.back() = 9;
  send(longest);
  ASSERT_TRUE(run_until(io, [&] { return probe.received.size() == longest.size(); }));
  EXPECT_EQ(probe.received, longest);
  stream->close();
  ASSERT_TRUE(run_until(io, [this] { return !probe.closed.empty(); }));
  EXPECT_EQ(probe.closed.front(), "closed by the peer");
}

TEST_F(TlsPortTest, ReceivedBytesAreDroppedOnlyIfNoOtherRequestWaits) {
  const auto made = make_port(io, spec());
  Port& port = *made;
  connect(port);
  send({1});
  port.write(Bytes{0});
  send({2});
  port.write_more(Bytes{0});
  send({3});
  ASSERT_TRUE(run_until(io, [&] { return !probe.received.empty() && probe.received.back() == 3; }));
  EXPECT_EQ(probe.received, (Bytes{2, 3}));
}

TEST_F(TlsPortTest, ItIsNotLeased) {
  const auto made = make_port(io, spec());
  Port& port = *made;
  connect(port);
  EXPECT_FALSE(port.lease().valid());
  port.write(Bytes{5});
  EXPECT_EQ(receive(), Bytes{5});
}

TEST_F(TlsPortTest, ACertificateOfAnotherIssuerIsRefused) {
  serve(own("alone", "ca"));
  EXPECT_THAT(refusal(spec()), AllOf(HasSubstr("certificate of the server for '127.0.0.1'"),
                                     HasSubstr("self-signed certificate")));
}

TEST_F(TlsPortTest, ACertificateThatIsKnownItselfNeedsNoIssuer) {
  serve(own("plc", "ca"));
  const auto made = make_port(io, spec("bridge", "plc"));
  Port& port = *made;
  port.open(probe);
  EXPECT_TRUE(run_until(io, [this] { return probe.opened == 1; }));
}

TEST_F(TlsPortTest, ACertificateOfAnotherNameIsRefused) {
  serve(own("plc", "ca"));
  Spec other = spec();
  other.server_name = "10.0.0.7";
  EXPECT_THAT(refusal(other), AllOf(HasSubstr("'10.0.0.7'"), HasSubstr("IP address mismatch")));
}

TEST_F(TlsPortTest, AHostNameIsComparedWithTheNames) {
  serve(own("plc", "ca"));
  Spec other = spec();
  other.server_name = "press.example";
  EXPECT_THAT(refusal(other), AllOf(HasSubstr("'press.example'"), HasSubstr("ostname mismatch")));
}

TEST_F(TlsPortTest, AServerThatRefusesTheClientIsReported) {
  serve(own("plc", "alone"));
  EXPECT_THAT(refusal(spec()), HasSubstr("TLS: the server refuses this client: "));
}

TEST_F(TlsPortTest, AServerThatRefusesTheClientWithoutAReasonIsReported) {
  const auto made = make_port(io, spec());
  Port& port = *made;
  connect(port);
  stream->close();
  ASSERT_TRUE(run_until(io, [this] { return !probe.closed.empty(); }));
  EXPECT_EQ(probe.closed.front(),
            "closed by the peer after the TLS handshake; it may refuse the certificate of this "
            "client");
}

TEST_F(TlsPortTest, AServerWithoutTlsIsReported) {
  accept("HTTP/1.1 400 Bad Request\r\n\r\n");
  EXPECT_THAT(refusal(spec()), HasSubstr("the server does not speak TLS"));
}

TEST_F(TlsPortTest, AServerThatClosesInTheHandshakeIsReported) {
  acceptor.async_accept([](boost::system::error_code, tcp::socket) {});
  EXPECT_THAT(refusal(spec()),
              testing::AnyOf(HasSubstr("the server closed the connection during the handshake"),
                             HasSubstr("reset by peer")));
}

TEST_F(TlsPortTest, AHandshakeEndsAtTheTimeoutOfTheConnection) {
  accept(std::string("\x16\x03\x03\x40\x00", 5));  // the begin of a record that never ends
  Spec slow = spec();
  slow.connect_timeout = 100ms;
  EXPECT_EQ(refusal(slow), "no TLS handshake within 100ms");
}

TEST_F(TlsPortTest, RandomBytesAreNoServer) {
  std::mt19937 random{7};
  for (int round = 0; round < 300; ++round) {
    const auto engine = *TlsEngine::make(own("bridge", "ca"), "127.0.0.1");
    Bytes plain, out;
    ASSERT_TRUE(engine->receive({}, plain, out));
    EXPECT_FALSE(out.empty()) << "the first message of the client";
    bool open = true;
    for (int piece = 0; open && piece < 20; ++piece) {
      Bytes noise(1 + random() % 3000);
      for (std::uint8_t& byte : noise) byte = static_cast<std::uint8_t>(random());
      if (piece == 0 && round % 2 == 0) noise.insert(noise.begin(), {0x16, 3, 3});  // a record
      open = engine->receive(noise, plain, out);
    }
    EXPECT_FALSE(open);
    EXPECT_FALSE(engine->ready());
    EXPECT_FALSE(engine->fault().empty());
    EXPECT_TRUE(plain.empty());
    engine->send(Bytes{1, 2, 3}, out);
  }
}

TEST_F(TlsPortTest, FilesThatAreNotUsableAreNamed) {
  acceptor.async_accept(peer, [](boost::system::error_code) {});
  Spec wrong = spec();
  wrong.tls->key = files->file("none.key");
  EXPECT_THAT(refusal(wrong), HasSubstr("none.key"));
}

TEST_F(TlsPortTest, AKeyThatOthersCanReadIsRefused) {
  acceptor.async_accept(peer, [](boost::system::error_code) {});
  Spec open = spec();
  open.tls->key = files->write("open.key", files->text("bridge.key"), 0644);
  EXPECT_THAT(refusal(open), HasSubstr("open.key"));
}

TEST_F(TlsPortTest, AnExpiredCertificateOfTheBridgeIsNamed) {
  acceptor.async_accept(peer, [](boost::system::error_code) {});
  files->issue("old", "bridge");
  files->expire("old");
  EXPECT_THAT(refusal(spec("old")), HasSubstr("old.pem: the certificate has expired"));
}

TEST_F(TlsPortTest, AnExpiredCertificateOfTheServerIsRefused) {
  files->issue("past", "plc");
  files->expire("past");
  serve(own("past", "ca"));
  EXPECT_THAT(refusal(spec()), HasSubstr("certificate has expired"));
}

}  // namespace
}  // namespace fieldcast::test
