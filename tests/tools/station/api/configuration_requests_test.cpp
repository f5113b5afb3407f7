// The resources of /api/configuration, with a bridge that returns a given reply.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <atomic>
#include <boost/asio/executor_work_guard.hpp>
#include <boost/asio/io_context.hpp>
#include <future>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "tests/tools/station/api/api_support.hpp"
#include "tools/station/api/api_routes.hpp"
#include "tools/station/api/device_templates.hpp"

namespace fieldcast::web {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

class ConfigurationApi : public testing::Test {
 protected:
  using Body = nlohmann::json;

  HttpResponse ask(ApiHandler* handler, HttpRequest request) {
    std::optional<HttpResponse> response;
    handler(api_, request, Caller{"anna", Role::kEngineer, "127.0.0.1"},
            [&](HttpResponse given) { response = std::move(given); });
    while (!response) {
      io_.restart();
      io_.run_for(std::chrono::milliseconds{10});
    }
    return *std::move(response);
  }
  HttpResponse post(ApiHandler* handler, const Body& body) {
    HttpRequest request = test::request_of("/api/configuration", Method::kPost);
    request.body = body.dump();
    return ask(handler, std::move(request));
  }

  ConfigurationRequests::Replied reply_ =
      std::string(R"({"status":200,"body":"{\"version\":\"1\"}"})");
  Body sent_;
  boost::asio::io_context io_;
  ConfigurationRequests requests_{io_,
                                  [this](const std::string& bridge, const std::string& request) {
                                    sent_ = Body::parse(request);
                                    sent_["to"] = bridge;
                                    return reply_;
                                  },
                                  [] {}};
  Api api_{.configurations = &requests_};
};

TEST_F(ConfigurationApi, TheBridgeGetsTheRequestWithTheUser) {
  const Body body{{"bridge", "north:b"}, {"base", "0"}, {"text", "t"}, {"why", "w"}};
  const HttpResponse response = post(deploy_configuration, body);
  EXPECT_EQ(response.status, 200u);
  EXPECT_EQ(Body::parse(response.body), Body({{"version", "1"}}));
  EXPECT_EQ(sent_, Body({{"operation", "deploy"},
                         {"who", "anna"},
                         {"to", "north:b"},
                         {"base", "0"},
                         {"text", "t"},
                         {"why", "w"}}));
}

TEST_F(ConfigurationApi, AClientCannotChooseTheUserOrTheOperation) {
  for (const char* name : {"who", "operation", "x"}) {
    const HttpResponse response =
        post(confirm_configuration, {{"bridge", "b"}, {"version", "1"}, {name, "root"}});
    EXPECT_EQ(response.status, 400u) << name;
  }
  EXPECT_TRUE(sent_.is_null());
}

TEST_F(ConfigurationApi, TheStatusOfTheBridgeIsThatOfTheResponse) {
  reply_ = std::string(R"({"status":409,"body":"{\"error\":\"e\",\"hint\":\"h\"}"})");
  EXPECT_EQ(post(check_configuration, {{"bridge", "b"}, {"text", ""}}).status, 409u);
}

TEST_F(ConfigurationApi, AConfigurationNamesItsBridge) {
  const HttpResponse response =
      ask(show_configuration, test::request_of("/api/configuration?bridge=north:b"));
  EXPECT_EQ(Body::parse(response.body), Body({{"bridge", "north:b"}, {"version", "1"}}));
}

TEST_F(ConfigurationApi, AnInvalidReplyIsNotPassedOn) {
  for (const char* reply :
       {"", "[]", R"({"status":"200","body":"1"})", R"({"status":7,"body":"1"})",
        R"({"status":200,"body":1})", R"({"status":200,"body":"{"})", R"({"status":200})"}) {
    reply_ = std::string(reply);
    EXPECT_EQ(post(check_configuration, {{"bridge", "b"}, {"text", ""}}).status, 502u) << reply;
  }
}

TEST_F(ConfigurationApi, AFaultSaysWhatToDo) {
  reply_ = tl::unexpected(StationFault::kNoBridge);
  const HttpResponse away = post(check_configuration, {{"bridge", "b"}, {"text", ""}});
  EXPECT_EQ(away.status, 504u);
  EXPECT_THAT(away.body, HasSubstr("configure: { allow: true }"));
  reply_ = tl::unexpected(StationFault::kNoRight);
  const HttpResponse refused = post(check_configuration, {{"bridge", "b"}, {"text", ""}});
  EXPECT_EQ(refused.status, 403u);
  EXPECT_THAT(refused.body, HasSubstr("fieldcast secure add engineer"));
}

TEST(ConfigurationRequests, OtherWorkDoesNotWaitForASilentBridge) {
  boost::asio::io_context io;
  const auto guard = boost::asio::make_work_guard(io);
  std::promise<void> cancelled;
  ConfigurationRequests requests{
      io,
      [&](const std::string&, const std::string&) -> ConfigurationRequests::Replied {
        cancelled.get_future().wait();
        return tl::unexpected(StationFault::kNoResult);
      },
      [&] { cancelled.set_value(); }};
  ASSERT_TRUE(requests.send("b", "{}", [](const auto&) {}));
  bool done = false;
  ASSERT_TRUE(requests.run([] {}, [&] { done = true; }));
  EXPECT_EQ(io.run_one_for(std::chrono::seconds{10}), 1u);
  EXPECT_TRUE(done);
}

// After HttpLimits::handler the client has the response 503, and must be able to rely on it.
TEST(ConfigurationRequests, ALateRequestIsNotSent) {
  boost::asio::io_context io;
  const auto guard = boost::asio::make_work_guard(io);
  std::atomic<Duration> time{Duration{}};
  std::promise<void> first_is_sent, bridge_replies;
  const auto bridge_has_replied = bridge_replies.get_future().share();
  std::vector<std::string> sent;
  ConfigurationRequests requests{
      io,
      [&](const std::string&, const std::string& request) -> ConfigurationRequests::Replied {
        sent.push_back(request);
        if (sent.size() == 1) first_is_sent.set_value();
        bridge_has_replied.wait();
        return request;
      },
      [] {}, [&] { return Instant{time.load()}; }};
  std::vector<bool> have_replies;
  const auto done = [&](const auto& replied) { have_replies.push_back(replied.has_value()); };
  ASSERT_TRUE(requests.send("down", "first", done));
  ASSERT_TRUE(requests.send("b", "late", done));
  first_is_sent.get_future().wait();
  time = ConfigurationRequests::kPatience + Duration{1};
  bridge_replies.set_value();
  while (have_replies.size() < 2 && io.run_one_for(std::chrono::seconds{10}) == 1) {}
  EXPECT_THAT(have_replies, ElementsAre(true, false));
  EXPECT_THAT(sent, ElementsAre("first"));
}

TEST(DeviceTemplates, HaveMakerModelAndProtocol) {
  const DeviceTemplate meter = device_template_of(
      "em24", "# Device:   Carlo Gavazzi EM24-DIN, meter\nprotocols: [modbus-rtu, modbus-tcp]\n");
  EXPECT_EQ(meter.maker, "Carlo Gavazzi");
  EXPECT_EQ(meter.model, "EM24-DIN, meter");
  EXPECT_THAT(meter.head.protocols, ElementsAre("modbus-rtu", "modbus-tcp"));
  EXPECT_EQ(device_template_of("press", "description: Hydraulic press\n").model, "Hydraulic press");
  EXPECT_EQ(device_template_of("x", "").maker, "");
}

TEST(DeviceTemplates, AreProposedForTheIdentityOfAFoundDevice) {
  const std::vector templates{
      device_template_of("pac", "# Device: Siemens PAC3200\nprotocols: [modbus-rtu]\n")};
  const auto proposed = [&](const std::string& scan) { return with_templates(scan, templates); };
  EXPECT_EQ(proposed(R"({"found":[{"identity":"Siemens AG, PAC3200","protocol":"modbus-rtu"}]})"),
            R"({"found":[{"identity":"Siemens AG, PAC3200","protocol":"modbus-rtu",)"
            R"("templates":["pac"]}]})");
  EXPECT_THAT(proposed(R"({"found":[{"identity":"Siemens AG, PAC3200","protocol":"dtc"}]})"),
              HasSubstr(R"("templates":[])"));
  for (const char* other : {"[]", "{}", R"({"found":7})", R"({"found":[7]})"})
    EXPECT_EQ(proposed(other), other);
}

}  // namespace
}  // namespace fieldcast::web
