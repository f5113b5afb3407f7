#include "core/program/list_client.hpp"

namespace fieldcast::program {
namespace {

ListClient::Result failed(PortEnd::Kind kind, std::optional<Reply> reply, std::string text) {
  return tl::make_unexpected(PortEnd{kind, reply, std::move(text)});
}

}  // namespace

Bytes ListClient::request() const {
  Bytes out = login_frame(user_, password_);
  append(out, control_frame(kListCode));
  return out;
}

std::optional<ListClient::Result> ListClient::on_bytes(ByteView bytes) {
  if (over_) return std::nullopt;
  reader_.feed(bytes);
  while (const auto frame = reader_.next(MarkerReader::Phase::kHandshake)) {
    const auto* code = std::get_if<ControlCode>(&*frame);
    auto result = code != nullptr
                      ? on_code(code->code)
                      : failed(PortEnd::Kind::kProtocol, {}, "the peer is not a Fieldcast bridge");
    over_ = result.has_value();
    if (result) return result;
  }
  return std::nullopt;
}

std::optional<ListClient::Result> ListClient::on_code(std::string_view code) {
  if (code == kHeartbeatCode) return std::nullopt;
  if (const auto reply = reply_from(code)) {
    // A bridge of an earlier version expects a device number.
    return failed(PortEnd::Kind::kRefused, reply,
                  reply == Reply::kNotAllowed ? refusal_text(*reply, user_)
                                              : "the bridge does not list its devices: update it");
  }
  if (auto device = listed_device_from(code); device && list_.devices.size() < kMaxListed) {
    list_.devices.push_back(*std::move(device));
    return std::nullopt;
  }
  const auto count = list_end_from(code);
  if (!count || *count < list_.devices.size())
    return failed(PortEnd::Kind::kProtocol, {}, "the bridge sends an invalid list of devices");
  list_.omitted = *count - list_.devices.size();
  return std::move(list_);
}

}  // namespace fieldcast::program
