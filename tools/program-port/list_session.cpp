#include "tools/program-port/list_session.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "core/base/json.hpp"
#include "core/base/message_text.hpp"

namespace fieldcast::port {

using program::ListClient;
using program::PortEnd;

ListSession::ListSession(boost::asio::io_context& io, const BridgeOptions& bridge,
                         ListClient client)
    : place_(fmt::format("{}:{}", bridge.host, bridge.port)),
      client_(std::move(client)),
      dialer_(io, bridge),
      limit_(io) {}

void ListSession::start() {
  dialer_.dial([this](TlsResult stream) {
    if (stream) return connected(std::move(*stream));
    end(tl::make_unexpected(PortEnd{PortEnd::Kind::kBridgeGone, {}, stream.error()}));
  });
}

void ListSession::connected(std::unique_ptr<ByteStream> stream) {
  bridge_ = std::make_shared<program::RelayEnd>(std::move(stream));
  bridge_->start({[this](ByteView bytes) {
                    auto result = client_.on_bytes(bytes);
                    if (!result) return;
                    *result ? end(*std::move(result)) : fail(result->error());
                  },
                  [this](const std::string& reason) {
                    fail({PortEnd::Kind::kBridgeGone, {}, "the bridge disconnected: " + reason});
                  },
                  [](bool) {}});
  limit_.expires_after(ListClient::kLimit);
  limit_.async_wait([this](boost::system::error_code cancelled) {
    if (!cancelled) fail({PortEnd::Kind::kBridgeGone, {}, "the bridge does not respond"});
  });
  bridge_->send(client_.request());
}

void ListSession::fail(PortEnd end) {
  end.text = place_ + ": " + end.text;
  this->end(tl::make_unexpected(std::move(end)));
}

void ListSession::end(ListClient::Result result) {
  if (result_) return;
  result_ = std::move(result);
  limit_.cancel();
  if (!bridge_) return;
  bridge_->send(program::stop_frame(false));
  bridge_->finish(program::RelayEnd::Until::kTaken, [] {});
}

std::vector<std::string> lines_of(const program::DeviceList& list, bool json) {
  std::size_t number_width = 0, name_width = 0;
  const auto name_of = [](const program::ListedDevice& device) {
    return printable(device.bus + '/' + device.device);
  };
  for (const auto& device : list.devices) {
    number_width = std::max(number_width, device.number.size());
    name_width = std::max(name_width, name_of(device).size());
  }
  std::vector<std::string> lines;
  for (const auto& device : list.devices) {
    const std::string state(to_text(device.state));
    const std::string by = device.who.empty() ? "" : " by " + printable(device.who);
    lines.push_back(json ? Json{{"number", device.number},
                                {"bus", device.bus},
                                {"device", device.device},
                                {"state", state},
                                {"who", device.who}}
                               .text()
                         : fmt::format("{:{}}  {:{}}  {}{}", device.number, number_width,
                                       name_of(device), name_width, state, by));
  }
  if (list.omitted > 0)
    lines.push_back(json ? Json{{"omitted", list.omitted}}.text()
                         : counted(list.omitted, "device is", "devices are") + " not listed");
  if (lines.empty() && !json)
    lines.emplace_back(
        "no device of this bridge can be programmed: its configuration gives none a number");
  return lines;
}

}  // namespace fieldcast::port
