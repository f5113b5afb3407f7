#include "tools/cli/scan/identity.hpp"

#include <algorithm>
#include <array>

#include "core/base/message_text.hpp"
#include "core/codec/checksum.hpp"
#include "core/protocol/modbus/framing.hpp"
#include "tools/cli/scan/omron_identity.hpp"

namespace fieldcast::cli {
namespace {

constexpr std::uint8_t kFunction = 0x2B, kMeiType = 0x0E, kBasic = 0x01, kException = 0x80;
constexpr std::size_t kHeader = 7;   // function .. number of objects
constexpr std::size_t kObjects = 3;  // basic category: vendor, product code, revision
constexpr std::uint32_t kUsualAnswer = 60;
constexpr std::size_t kTcpHeader = 7;

enum class Form : std::uint8_t { kRtu, kAscii, kTcp };

// Length of the PDU that starts here; empty if it is incomplete or a different PDU.
std::optional<std::size_t> pdu_length(ByteView pdu) {
  if (pdu.size() >= 2 && pdu[0] == (kFunction | kException)) return 2;
  if (pdu.size() < kHeader || pdu[0] != kFunction || pdu[1] != kMeiType) return std::nullopt;
  std::size_t length = kHeader;
  for (unsigned object = 0; object < pdu[kHeader - 1]; ++object) {
    if (pdu.size() < length + 2) return std::nullopt;
    length += 2u + pdu[length + 1];
  }
  return pdu.size() < length ? std::nullopt : std::optional(length);
}

// Decodes the text after a frame's colon, up to the first invalid pair of digits.
Bytes bytes_of_text(ByteView text) {
  Bytes bytes;
  for (std::size_t i = 0; i + 1 < text.size(); i += 2) {
    const int high = modbus::ascii_digit(text[i]), low = modbus::ascii_digit(text[i + 1]);
    if (high < 0 || low < 0) break;
    bytes.push_back(static_cast<std::uint8_t>(high << 4 | low));
  }
  return bytes;
}

// Finds the PDU of a valid response of this unit; empty if there is none yet.
Bytes find_pdu(Form form, ByteView all, std::uint8_t unit) {
  for (std::size_t at = 0; at < all.size(); ++at) {
    ByteView frame = all.subspan(at);
    Bytes decoded;
    if (form == Form::kTcp) {
      if (frame.size() <= kTcpHeader || frame[kTcpHeader - 1] != unit) return {};
      frame = frame.subspan(kTcpHeader - 1);
    } else if (form == Form::kAscii) {
      if (frame[0] != ':') continue;
      decoded = bytes_of_text(frame.subspan(1));
      frame = decoded;
    }
    if (frame.empty() || frame[0] != unit) continue;
    const auto length = pdu_length(frame.subspan(1));
    if (!length) continue;
    const std::size_t end = 1 + *length;
    const bool checked =
        form == Form::kTcp ||
        (form == Form::kRtu && frame.size() >= end + 2 &&
         crc16_modbus(frame.first(end)) == (frame[end] | frame[end + 1] << 8)) ||
        (form == Form::kAscii && frame.size() > end && lrc8(frame.first(end)) == frame[end]);
    if (checked) return {frame.begin() + 1, frame.begin() + static_cast<std::ptrdiff_t>(end)};
    if (form == Form::kTcp) return {};
  }
  return {};
}

std::string text_of(ByteView pdu) {
  std::string text;
  std::size_t at = kHeader;
  for (unsigned object = 0; object < pdu[kHeader - 1] && object < kObjects; ++object) {
    const std::size_t length = pdu[at + 1];
    const std::string value(pdu.begin() + static_cast<std::ptrdiff_t>(at + 2),
                            pdu.begin() + static_cast<std::ptrdiff_t>(at + 2 + length));
    if (!value.empty()) text += (text.empty() ? "" : ", ") + value;
    at += 2 + length;
  }
  return text;
}

class ModbusIdentity final : public Exchange {
 public:
  ModbusIdentity(Form form, const modbus::Framing& framing, std::uint8_t unit)
      : form_(form), framing_(framing), unit_(unit) {}

  Step start(Bytes& out) override {
    constexpr std::array<std::uint8_t, 4> kRequest{kFunction, kMeiType, kBasic, 0};
    framing_.wrap({unit_, 1}, kRequest, out);
    return Step::send(kUsualAnswer);
  }
  Step on_bytes(ByteView all, Bytes&) override {
    if (all.size() > modbus::kMaxReceived) return Step::failed(Cause::kOverlong);
    const Bytes pdu = find_pdu(form_, all, unit_);
    if (pdu.empty()) return Step::need_rest(1);
    if (pdu[0] != kFunction) return Step::failed(Cause::kDeviceError, pdu[1]);
    const std::string text = text_of(pdu);
    reply_.assign(1, RangeReply{Cause::kNone, 0, Bytes(text.begin(), text.end())});
    return Step::done();
  }
  Step on_silence(Bytes&) override { return Step::failed(Cause::kNoAnswer); }
  const Reply& reply() const override { return reply_; }

 private:
  const Form form_;
  const modbus::Framing& framing_;
  const std::uint8_t unit_;
  Reply reply_;
};

}  // namespace

std::unique_ptr<Exchange> identity_exchange(std::string_view protocol, std::uint16_t address) {
  const auto unit = static_cast<std::uint8_t>(address);
  if (protocol == "modbus-rtu")
    return std::make_unique<ModbusIdentity>(Form::kRtu, modbus::rtu_framing(), unit);
  if (protocol == "modbus-ascii")
    return std::make_unique<ModbusIdentity>(Form::kAscii, modbus::ascii_framing(), unit);
  if (protocol == "modbus-tcp")
    return std::make_unique<ModbusIdentity>(Form::kTcp, modbus::tcp_framing(), unit);
  if (protocol == "omron-hostlink") return hostlink_identity(address);
  return nullptr;
}

std::optional<TypeAddress> type_address(std::string_view protocol) {
  if (protocol == "mitsubishi-fx") return TypeAddress{"D8001", "type and version"};
  if (protocol == "s7-ppi") return TypeAddress{"SMB6", "CPU"};
  return std::nullopt;
}

}  // namespace fieldcast::cli
