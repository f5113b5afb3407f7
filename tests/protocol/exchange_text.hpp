// Exchanges as texts: lines that request something of one device and feed it bytes, each followed
// by what the protocol returns. The bytes of the lines add up, as on a wire, until the next send.
//
//   device 17 echo=false   a device with this address and these options
//   read holding:107 3 holding:200 1 | write holding:107 00 05 [bit 3] [distinct]
//   < 11 03 06             bytes of the response; " begins characters, with \r, \n and \xNN
//   silence                the wait of the last step has expired
//   after read holding:1 3 | read holding:2 3     whether a late response could be confused
//   address holding:1.16 | explain 11 03 06
#pragma once

#include <functional>
#include <sstream>
#include <string>
#include <vector>

#include "tests/protocol/facts.hpp"

namespace fieldcast::test {

class ExchangeText {
 public:
  using Make = std::function<std::unique_ptr<Protocol>(const DeviceLink&)>;
  using Explain = std::function<std::vector<FrameField>(ByteView)>;
  ExchangeText(Make make, Explain explain)
      : make_(std::move(make)), explain_(std::move(explain)), protocol_(make_({.address = 1})) {}

  std::string respond(const std::string& line) {
    const auto space = line.find(' ');
    const std::string word = line.substr(0, space);
    const std::string rest = space == std::string::npos ? "" : line.substr(space + 1);
    if (word == "device") return device(rest);
    if (word == "address") return address_text(*protocol_, rest);
    if (word == "explain") return explained(from_hex(rest).value());
    if (word == "after") return after(rest);
    if (word == "<") return received(from_hex(rest).value());
    if (word == "\"") return received(characters(rest));
    if (word == "read" || word == "write") return begin(line);
    if (word != "silence" || !exchange_) return "  !! unknown: " + line + '\n';
    Bytes out;
    return step(exchange_->on_silence(out), out);
  }

 private:
  std::string device(const std::string& text) {
    std::istringstream words(text);
    DeviceLink link;
    words >> link.address;
    for (std::string option; words >> option;)
      link.options[option.substr(0, option.find('='))] = option.substr(option.find('=') + 1);
    exchange_.reset();
    protocol_ = make_(link);
    return {};
  }

  // Empty with a message in `fault` if the request cannot be sent.
  std::optional<Request> request(const std::string& text, std::string& fault) const {
    std::istringstream words(text);
    std::string word, at;
    words >> word;
    std::vector<Range> ranges;
    WriteRequest write;
    const bool reads = word == "read";
    for (std::uint32_t count = 1; words >> at && (!reads || words >> count);) {
      const auto parsed = protocol_->parse_address(at);
      if (!parsed) {
        fault = "  " + parsed.error().what + '\n';
        return std::nullopt;
      }
      ranges.push_back({parsed->area, parsed->first, count});
      if (!reads) break;
    }
    std::string digits;
    while (!reads && words >> word) {
      if (word == "distinct")
        write.distinct_response = true;
      else if (unsigned bit = 0; word == "bit" && words >> bit)
        write.bit = static_cast<std::uint8_t>(bit);
      else
        digits += word;
    }
    Request made = ReadRequest{ranges};
    if (!reads) {
      write.items = from_hex(digits).value();
      write.range = ranges.front();
      const Area& area = protocol_->areas()[write.range.area];
      write.range.count =
          static_cast<std::uint32_t>(write.items.size() / image_bytes(area.item_bits, 1));
      made = write;
    }
    if (protocol_->size(made)) return made;
    fault = "  not possible\n";
    return std::nullopt;
  }

  std::string begin(const std::string& line) {
    std::string fault;
    const auto made = request(line, fault);
    exchange_.reset();
    if (!made) return fault;
    exchange_ = protocol_->begin(*made, {1, nullptr});
    Bytes out;
    return step(exchange_->start(out), out);
  }

  std::string after(const std::string& text) const {
    std::string fault;
    const auto earlier = request(text.substr(0, text.find(" | ")), fault);
    const auto later = request(text.substr(text.find(" | ") + 3), fault);
    if (!earlier || !later) return fault;
    return protocol_->mistakable(*earlier, {1, nullptr}, *later, {2, nullptr})
               ? "  could be confused\n"
               : "  cannot be confused\n";
  }

  std::string received(const Bytes& bytes) {
    if (!exchange_) return "  !! no exchange\n";
    append(received_, bytes);
    Bytes out;
    return step(exchange_->on_bytes(received_, out), out);
  }

  std::string step(const Step& step, const Bytes& out) {
    const std::string sent = out.empty() ? "" : "  > " + to_hex(out) + '\n';
    switch (step.kind) {
      case Step::Kind::kSend:
        received_.clear();
        return sent + "  " + wait(step, "expects ") +
               (step.response_baud == 0 ? ""
                                        : " at " + std::to_string(step.response_baud) + " baud") +
               '\n';
      case Step::Kind::kNeedMore: return "  " + wait(step, "waits for ") + '\n';
      case Step::Kind::kFailed:
        exchange_.reset();
        return sent + "  failed: " + std::string(to_text(step.cause)) +
               (step.device_code == 0 ? "" : ", code " + std::to_string(step.device_code)) + '\n';
      case Step::Kind::kDone: break;
    }
    std::string text = sent;
    for (const RangeReply& range : exchange_->reply()) {
      text += "  done: " + to_hex(range.items);
      if (range.cause != Cause::kNone)
        text += std::string(to_text(range.cause)) + ", code " + std::to_string(range.device_code);
      for (const Range& absent : range.absent)
        text += ", without " + std::to_string(absent.first) + ".." + std::to_string(absent.end());
      text += '\n';
    }
    exchange_.reset();
    return text;
  }

  static std::string wait(const Step& step, const std::string& verb) {
    if (step.wait == Wait::kPause) return "pauses for " + fieldcast::to_text(step.pause);
    if (step.kind == Step::Kind::kNeedMore && step.wait == Wait::kResponse)
      return "waits for a response";
    return verb + std::to_string(step.characters) +
           (step.kind == Step::Kind::kNeedMore ? " more" : "");
  }

  std::string explained(const Bytes& frame) const {
    std::string text;
    for (const FrameField& field : explain_(frame))
      text += std::string(2 + 2 * field.depth, ' ') + std::to_string(field.offset) + '+' +
              std::to_string(field.length) + ' ' + field.name + (field.value.empty() ? "" : ": ") +
              field.value + (field.fault.empty() ? "" : " !! " + field.fault) + '\n';
    return text;
  }

  static Bytes characters(const std::string& text) {
    Bytes bytes;
    for (std::size_t at = 0; at < text.size(); ++at) {
      if (text[at] != '\\' || at + 1 == text.size()) {
        bytes.push_back(static_cast<std::uint8_t>(text[at]));
        continue;
      }
      const char kind = text[++at];
      if (kind == 'r' || kind == 'n') {
        bytes.push_back(kind == 'r' ? '\r' : '\n');
        continue;
      }
      append(bytes, from_hex(text.substr(at + 1, 2)).value());
      at += 2;
    }
    return bytes;
  }

  Make make_;
  Explain explain_;
  std::unique_ptr<Protocol> protocol_;
  std::unique_ptr<Exchange> exchange_;
  Bytes received_;  // since the last send
};

}  // namespace fieldcast::test
