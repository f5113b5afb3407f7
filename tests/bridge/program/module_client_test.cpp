#include "bridge/program/module/module_client.hpp"

#include <boost/asio/post.hpp>
#include <future>

#include "bridge/port/serial_line.hpp"
#include "tests/bridge/program/program_support.hpp"
#include "tests/bridge/support/certificates.hpp"
#include "tests/bridge/support/pty.hpp"

namespace fieldcast::test {
namespace {

using std::chrono::milliseconds;
using testing::HasSubstr;

constexpr const char* kHutSecret = "the secret of the hut by the river";

struct ModuleClientTest : ServerFixture {
  ModuleClientTest() {
    options.host = "127.0.0.1";
    options.number = "17";
    options.again = milliseconds{50};
  }
  ~ModuleClientTest() override {
    if (!client) return;
    std::promise<void> stopped;
    boost::asio::post(io.context(), [&] {
      client->stop();
      boost::asio::post(io.context(), [&] { stopped.set_value(); });
    });
    stopped.get_future().wait();
  }
  void dial() {
    options.port = server.modules_port();
    client = std::make_shared<program::ModuleClient>(
        io.context(), options,
        [this]() -> tl::expected<FileDescriptor, std::string> {
          FileDescriptor opened(
              ::open(line.path().c_str(), O_RDWR | O_NOCTTY | O_NONBLOCK | O_CLOEXEC));
          SerialPortSpec settings;
          if (const auto set = set_up_line(opened.get(), settings); !set)
            return tl::unexpected(set.error());
          return opened;
        },
        [this](const std::string& text) {
          {
            const std::lock_guard lock(mutex);
            said += text + '\n';
          }
          changed.notify_all();
        });
    boost::asio::post(io.context(), [this] { client->start(); });
  }
  bool says(const std::string& text) {
    std::unique_lock lock(mutex);
    return changed.wait_for(lock, std::chrono::seconds{10},
                            [&] { return said.find(text) != std::string::npos; });
  }
  void expect_programmable() {
    std::unique_ptr<TcpClient> engineer;
    ASSERT_EQ(paired(server.engineers_port(), "17", engineer), "@@0000FEFF");
    engineer->send("@@@00x*\rFEFF");
    const Bytes request = line.receive(6);
    EXPECT_EQ(std::string(request.begin(), request.end()), "@00x*\r");
    const std::string answer = "@00y*\r";
    line.send({reinterpret_cast<const std::uint8_t*>(answer.data()), answer.size()});
    EXPECT_EQ(engineer->receive("\rFEFF"), "@@@00y*\rFEFF");
  }

  Certificates files;
  Pty line;
  program::ModuleOptions options;
  std::string said;
  IoThread io{"module"};
  std::shared_ptr<program::ModuleClient> client;
};

TEST_F(ModuleClientTest, ReportsItsNumberAndCarriesBytesBothWays) {
  start();
  dial();
  expect_programmable();
}

TEST_F(ModuleClientTest, ShowsItsCertificateAndProvesItsSecret) {
  files.issue("bridge", "bridge");
  files.issue("hut", "17");
  spec.modules->tls = {files.file("bridge.pem"), files.file("bridge.key"), files.file("ca.pem"),
                       ""};
  spec.modules->secrets = files.write("secrets", std::string("17 ") + kHutSecret + '\n');
  spec.modules->registration.prefix = "ID=";
  start();
  options.tls = true;
  options.authorities = files.file("ca.pem");
  options.own = {files.file("hut.pem"), files.file("hut.key"), "", ""};
  options.secret = Secret(kHutSecret);
  options.prefix = "ID=";
  dial();
  expect_programmable();
  const std::lock_guard lock(mutex);
  EXPECT_THAT(said, testing::Not(HasSubstr(kHutSecret)));
}

TEST_F(ModuleClientTest, SaysWhyItIsRefusedAndDialsInAgain) {
  spec.modules->secrets = files.write("secrets", std::string("17 ") + kHutSecret + '\n');
  start();
  options.secret = Secret("another secret of nobody");
  dial();
  EXPECT_TRUE(says("refused: module 17 does not know its secret"));
  EXPECT_TRUE(audited("module 17 does not know its secret"));
}

TEST_F(ModuleClientTest, SaysThatItLacksASecret) {
  spec.modules->secrets = files.write("secrets", std::string("17 ") + kHutSecret + '\n');
  start();
  dial();
  EXPECT_TRUE(says("the bridge asks for a secret"));
}

}  // namespace
}  // namespace fieldcast::test
