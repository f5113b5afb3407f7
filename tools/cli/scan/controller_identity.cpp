#include <fmt/format.h>

#include <algorithm>
#include <functional>

#include "core/base/message_text.hpp"
#include "core/protocol/mitsubishi_mc/frame.hpp"
#include "core/protocol/s7_tcp/iso_frame.hpp"
#include "tools/cli/scan/identity.hpp"

namespace fieldcast::cli {
namespace {

constexpr std::size_t kLargestResponse = 8192;

struct Question {
  Bytes request;
  // Text of the response; empty for a refusal.
  std::function<std::string(ByteView frame)> text;
};

// Sends one question after the other and joins the texts with commas.
class Enquiry final : public Exchange {
 public:
  Enquiry(Framer first_frame, std::vector<Question> questions)
      : first_frame_(first_frame), questions_(std::move(questions)) {}

  Step start(Bytes& out) override { return send(out); }

  Step on_bytes(ByteView all, Bytes& out) override {
    const auto size = first_frame_(all);
    if (!size || all.size() > kLargestResponse) return end(Cause::kMalformed);
    if (*size == 0) return Step::need_response();
    const std::string text = questions_[at_].text(all.first(*size));
    if (!text.empty()) text_ += (text_.empty() ? "" : ", ") + text;
    return ++at_ < questions_.size() ? send(out) : end(Cause::kForeign);
  }

  Step on_silence(Bytes&) override { return end(Cause::kNoResponse); }
  const Reply& reply() const override { return reply_; }

 private:
  Step send(Bytes& out) {
    append(out, questions_[at_].request);
    return Step::send(questions_[at_].request.size());
  }
  Step end(Cause cause) {
    if (text_.empty()) return Step::failed(cause);
    reply_.assign(1, RangeReply{Cause::kNone, 0, Bytes(text_.begin(), text_.end())});
    return Step::done();
  }

  const Framer first_frame_;
  const std::vector<Question> questions_;
  std::size_t at_ = 0;
  std::string text_;
  Reply reply_;
};

// The characters of a field, without the blanks and zeros that fill it; empty beyond the end.
std::string field(ByteView bytes, std::size_t at, std::size_t size) {
  if (bytes.size() < at + size) return {};
  const ByteView part = bytes.subspan(at, size);
  std::string text(part.begin(), std::ranges::find(part, std::uint8_t{0}));
  text.erase(text.find_last_not_of(' ') + 1);
  return escaped(text);
}

// System status lists of an S7 CPU (System Software for S7-300/400, volume 2, A5E00739858-01,
// chapter 33):
//
//     request   32 07 0000 ref(2) 0008 0008, 000112 04 11 44 01 00, FF 09 0004 list(2) index(2)
//     response  32 07 0000 ref(2) 000C size(2), 12 bytes, FF 09 size(2) list(2) index(2)
//               size of a record(2) records(2), then the records, each with its index(2) first
constexpr std::size_t kParameters = 10, kResponseData = 22, kRecords = 12;

Bytes list_request(std::uint16_t reference, std::uint16_t list, std::uint16_t index) {
  Bytes message{0x32, 0x07, 0, 0};
  append_u16(message, reference);
  append(message, Bytes{0, 8, 0, 8, 0, 1, 0x12, 4, 0x11, 0x44, 1, 0, 0xFF, 9, 0, 4});
  append_u16(message, list);
  append_u16(message, index);
  Bytes frame;
  s7_tcp::append_data(frame, message);
  return frame;
}

// The records; empty for a refusal. Of a list in several messages only the first one.
ByteView records_of(ByteView frame) {
  const ByteView message = s7_tcp::first_iso_frame(frame, frame.size()).message;
  if (message.size() < kResponseData + kRecords || message[1] != 0x07 ||
      read_u16(message, 6) != kResponseData - kParameters || message[kResponseData] != 0xFF)
    return {};
  return message.subspan(kResponseData + kRecords);
}

// Empty if the list has none with this index.
ByteView record_of(ByteView frame, std::size_t size, std::uint16_t index) {
  for (ByteView records = records_of(frame); records.size() >= size;
       records = records.subspan(size)) {
    if (read_u16(records) == index) return records.first(size);
  }
  return {};
}

std::string type_name(ByteView frame) { return field(record_of(frame, 34, 7), 2, 32); }

std::string order_number(ByteView frame) {
  constexpr std::size_t kRecord = 28, kVersionAt = 25;
  const std::string number = field(record_of(frame, kRecord, 1), 2, 20);
  const ByteView firmware = record_of(frame, kRecord, 7);
  if (number.empty() || firmware.empty()) return number;
  const ByteView version = firmware.subspan(kVersionAt);
  return fmt::format("{}, V{}.{}.{}", number, version[0], version[1], version[2]);
}

std::string connections(ByteView frame) {
  const ByteView records = records_of(frame);
  if (records.size() < 6) return {};
  return fmt::format("PDU {} bytes, {} connections", read_u16(records, 2), read_u16(records, 4));
}

std::vector<Question> s7_questions(std::uint16_t reference) {
  return {{list_request(reference, 0x001C, 0), type_name},
          {list_request(reference, 0x0011, 0), order_number},
          {list_request(reference, 0x0131, 1), connections}};
}

mitsubishi_mc::Format format_of(const ScanLine& line) {
  return {.numbered = line.options.contains("frame"), .ascii = line.options.contains("code")};
}

// Of both frames; their first character shows the code, the second one of ASCII code the frame.
std::optional<std::size_t> first_mc_frame(ByteView stream) {
  const bool ascii = !stream.empty() && stream[0] == 'D';
  const bool numbered =
      ascii ? stream.size() > 1 && stream[1] == '4' : !stream.empty() && stream[0] == 0xD4;
  const auto response =
      mitsubishi_mc::first_response(stream, {.numbered = numbered, .ascii = ascii});
  if (response.kind == mitsubishi_mc::Response::Kind::kHopeless) return std::nullopt;
  return response.size;
}

std::vector<Question> mc_questions(const mitsubishi_mc::Format& format, std::uint16_t serial) {
  constexpr std::size_t kName = 16;
  Bytes content, request;
  mitsubishi_mc::append_number(content, format, 0x0101, 2);
  mitsubishi_mc::append_number(content, format, 0, 2);
  mitsubishi_mc::append_request(request, format, serial, {}, 0, content);
  return {{std::move(request), [format](ByteView frame) -> std::string {
             const auto response = mitsubishi_mc::first_response(frame, format);
             const ByteView data = response.data;
             if (response.end_code != 0 || data.size() < kName + 2 * format.width()) return {};
             const auto code = mitsubishi_mc::read_number(data.subspan(kName), format, 2);
             if (!code) return {};
             return fmt::format("{} (code {:04X})", field(data, 0, kName), *code);
           }}};
}

// "FINS" length(4) 0002 0000, then 80 00 02, node of the PLC, that of the client, SID 0501
std::vector<Question> fins_questions(std::uint8_t client, std::uint8_t node, std::uint8_t sid) {
  constexpr std::size_t kFrame = 16, kCommand = kFrame + 10, kEnd = kCommand + 2, kText = kEnd + 2;
  return {{{'F', 'I',  'N', 'S',  0, 0,    0, 21, 0,      0, 0,   2,    0,    0, 0,
            0,   0x80, 0,   0x02, 0, node, 0, 0,  client, 0, sid, 0x05, 0x01, 0},
           [](ByteView frame) -> std::string {
             // Bits 6 and 7 of the end code only report errors of the CPU.
             if (frame.size() < kText || read_u16(frame, kCommand) != 0x0501 ||
                 (read_u16(frame, kEnd) & 0xFF3F) != 0)
               return {};
             const std::string version = field(frame, kText + 20, 20);
             return field(frame, kText, 20) + (version.empty() ? "" : ", " + version);
           }}};
}

}  // namespace

std::unique_ptr<Exchange> controller_identity(const ScanLine& line, ExchangeContext context) {
  const std::string_view protocol = line.protocol.name();
  if (protocol == "mitsubishi-mc")
    return std::make_unique<Enquiry>(first_mc_frame,
                                     mc_questions(format_of(line), context.sequence));
  const Framer first_frame =
      line.protocol.built_in != nullptr ? line.protocol.built_in->first_frame : nullptr;
  if (protocol == "s7-tcp")
    return std::make_unique<Enquiry>(first_frame, s7_questions(context.sequence));
  if (protocol == "omron-fins" && context.session != nullptr && context.session->size() == 2)
    return std::make_unique<Enquiry>(first_frame,
                                     fins_questions((*context.session)[0], (*context.session)[1],
                                                    static_cast<std::uint8_t>(context.sequence)));
  return nullptr;
}

}  // namespace fieldcast::cli
