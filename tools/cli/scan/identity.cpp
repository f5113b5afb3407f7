#include "tools/cli/scan/identity.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <string_view>

#include "core/base/message_text.hpp"
#include "core/codec/digits.hpp"
#include "core/protocol/omron_hostlink/hostlink.hpp"

namespace fieldcast::cli {

std::unique_ptr<Exchange> identity_exchange(const ScanLine& line, std::uint16_t address,
                                            ExchangeContext context) {
  const std::string_view protocol = line.protocol.name();
  if (protocol == "omron-hostlink") return hostlink_identity(address);
  return controller_identity(line, context);
}

namespace {

using omron::ParseResult;

struct HostLinkModel {
  std::uint8_t code;
  std::string_view name;
};

// Omron W342, 4-3-30; the CPM2 and SRM1: Omron W353, 4-5-26.
constexpr std::array kModels{
    HostLinkModel{0x01, "C250"},
    HostLinkModel{0x02, "C500"},
    HostLinkModel{0x03, "C120/C50"},
    HostLinkModel{0x09, "C250F"},
    HostLinkModel{0x0A, "C500F"},
    HostLinkModel{0x0B, "C120F"},
    HostLinkModel{0x0E, "C2000"},
    HostLinkModel{0x10, "C1000H"},
    HostLinkModel{0x11, "C2000H/CQM1/CPM1/CPM2/SRM1"},
    HostLinkModel{0x12, "C20H/C28H/C40H/C200H/C200HS/C200HX/HG/HE"},
    HostLinkModel{0x20, "CV500"},
    HostLinkModel{0x21, "CV1000"},
    HostLinkModel{0x22, "CV2000"},
    HostLinkModel{0x30, "CS/CJ"},
    HostLinkModel{0x40, "CVM1-CPU01-E"},
    HostLinkModel{0x41, "CVM1-CPU11-E"},
    HostLinkModel{0x42, "CVM1-CPU21-E"},
};

constexpr std::uint8_t kFinsModel = 0x30;  // a model that also supports FINS
constexpr std::size_t kMostReceived = 2048;
constexpr std::uint32_t kModelResponse = 13;  // @uuMM ee cc FCS * CR
constexpr std::uint32_t kFinsResponse = 211;  // @uuFA ee, 100 bytes as digits, FCS * CR
// FINS response: ICF DA2 SA2 SID, command, end code, and two texts (W342, 5-3-15).
constexpr std::size_t kCommandAt = 4, kEndAt = 6, kTextAt = 8, kTextSize = 20;
constexpr std::array<std::uint8_t, 7> kReadCpuData{0, 0, 0, 0x01, 0x05, 0x01, 0};

// Removes trailing spaces and zeros.
std::string field_text(ByteView field) {
  std::string text(field.begin(), field.end());
  text.erase(std::find(text.begin(), text.end(), '\0'), text.end());
  text.erase(text.find_last_not_of(' ') + 1);
  return text;
}

class HostLinkIdentity final : public Exchange {
 public:
  explicit HostLinkIdentity(std::uint16_t unit) : unit_(unit) {}

  Step start(Bytes& out) override {
    omron::append_head(out, unit_, "MM");
    omron::append_end(out, 0, true);
    return Step::send(kModelResponse);
  }

  Step on_bytes(ByteView all, Bytes& out) override {
    if (all.size() > kMostReceived) return give_up(Cause::kOverlong);
    for (;;) {
      const ParseResult parsed = omron::first_frame(all);
      if (parsed.kind == ParseResult::Kind::kNothing) return Step::need_response();
      if (parsed.kind == ParseResult::Kind::kOpen) return Step::need_rest(1);
      if (parsed.kind == ParseResult::Kind::kFrame && parsed.last) {
        const Step step = take(parsed.text, out);
        if (step.kind != Step::Kind::kNeedMore) return step;
      }
      all = all.subspan(parsed.end);
    }
  }

  Step on_silence(Bytes&) override { return give_up(Cause::kNoResponse); }
  const Reply& reply() const override { return reply_; }

 private:
  // Processes a frame with a valid FCS of any unit.
  Step take(ByteView text, Bytes& out) {
    if (text.size() < omron::kHeadSize || read_digits(text.subspan(1, 2), 10) != unit_)
      return Step::need_response();
    const std::string header(text.begin() + 3, text.begin() + omron::kHeadSize);
    const ByteView rest = text.subspan(omron::kHeadSize);
    if (header == "IC") return give_up(Cause::kDeviceError, 0x16);
    if (text_.empty()) return header == "MM" ? take_model(rest, out) : Step::need_response();
    return header == "FA" ? take_cpu_data(rest) : Step::need_response();
  }

  Step take_model(ByteView rest, Bytes& out) {
    const auto end = rest.size() >= 2 ? read_digits(rest.first(2)) : std::nullopt;
    if (!end) return Step::need_response();
    if (*end != 0) return give_up(Cause::kDeviceError, static_cast<std::uint16_t>(*end));
    const auto code = rest.size() == 4 ? read_digits(rest.last(2)) : std::nullopt;
    if (!code) return Step::need_response();
    text_ = hostlink_model_text(static_cast<std::uint8_t>(*code));
    if (*code != kFinsModel) return done();
    omron::append_head(out, unit_, "FA");
    append_digits(out, 0, 1);  // no wait
    append_hex_bytes(out, kReadCpuData);
    omron::append_end(out, 0, true);
    return Step::send(kFinsResponse);
  }

  // ee, then the message as digits
  Step take_cpu_data(ByteView rest) {
    const auto bytes = read_hex_bytes(rest);
    if (!bytes || bytes->empty()) return Step::need_response();
    const ByteView message = ByteView(*bytes).subspan(1);
    if (bytes->front() != 0 || message.size() < kTextAt + kTextSize) return done();
    if (message[3] != kReadCpuData[3] || read_u16(message, kCommandAt) != 0x0501)
      return Step::need_response();
    // Bits 6 and 7 only report CPU errors.
    if ((read_u16(message, kEndAt) & 0xFF3F) != 0) return done();
    add(field_text(message.subspan(kTextAt, kTextSize)));
    if (message.size() >= kTextAt + 2 * kTextSize)
      add(field_text(message.subspan(kTextAt + kTextSize, kTextSize)));
    return done();
  }

  void add(const std::string& text) {
    if (!text.empty()) text_ += ", " + text;
  }
  Step done() {
    reply_.assign(1, RangeReply{Cause::kNone, 0, Bytes(text_.begin(), text_.end())});
    return Step::done();
  }
  // Keeps the first response if the second request fails.
  Step give_up(Cause cause, std::uint16_t code = 0) {
    return text_.empty() ? Step::failed(cause, code) : done();
  }

  const std::uint16_t unit_;
  std::string text_;  // received so far
  Reply reply_;
};

}  // namespace

std::unique_ptr<Exchange> hostlink_identity(std::uint16_t unit) {
  return std::make_unique<HostLinkIdentity>(unit);
}

std::string hostlink_model_text(std::uint8_t code) {
  const auto row = std::ranges::find(kModels, code, &HostLinkModel::code);
  return fmt::format("{} (model code {:02X})", row == kModels.end() ? "unknown model" : row->name,
                     code);
}

}  // namespace fieldcast::cli
