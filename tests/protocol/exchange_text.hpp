// Exchanges as texts: lines that request something of one device and feed it bytes, each followed
// by what the protocol returns. The bytes of the lines add up, as on a wire, until the next send.
//
//   device 17 echo=false   a device with this address and these options
//   read holding:107 3 holding:200 1 | write holding:107 00 05 [bit 3] [distinct]
//   < 11 03 06             bytes of the response; " begins characters, with \r, \n and \xNN
//   silence                the wait of the last step has expired
//   damaged 11 03 06       what becomes of these bytes if a part of them is lost, doubled or wrong
//   after read holding:1 3 | read holding:2 3     whether a late response could be confused
//   address holding:1.16 | explain 11 03 06
//
// `damaged` has a sign for each byte: the result if the bytes end before it (cut), if it is lost,
// doubled, or differs by 01 or by 10. `=` is the right reply, `*` a wrong one, `>` a request that
// follows. Letters are failures, in lower case if they follow from the silence behind the bytes:
// No response, Truncated, Checksum, Malformed, Foreign, Overlong, device Error, device Busy.
// `missing` are the characters that the exchange waits for where the bytes are cut; `-`: a whole
// response.
#pragma once

#include <algorithm>
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
    if (word == "damaged")
      return damaged(rest.starts_with("\" ") ? characters(rest.substr(2)) : from_hex(rest).value());
    if (word == "address") return address_text(*protocol_, rest);
    if (word == "explain") return explained(from_hex(rest).value());
    if (word == "after") return after(rest);
    if (word == "<") return received(from_hex(rest).value());
    if (word == "\"") return received(characters(rest));
    if (word == "read" || word == "write") return begin(line);
    if (word == "silence" && exchange_) return silence();
    return "  !! unknown: " + line + '\n';
  }

 private:
  std::string device(const std::string& text) {
    std::istringstream words(text);
    DeviceLink link;
    words >> link.address;
    for (std::string option; words >> option;)
      link.options[option.substr(0, option.find('='))] = option.substr(option.find('=') + 1);
    exchange_.reset();
    device_ = text;
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
    begun_ = line;
    before_.clear();
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
    before_.push_back(bytes);
    append(received_, bytes);
    Bytes out;
    return step(exchange_->on_bytes(received_, out), out);
  }

  std::string silence() {
    before_.push_back({});
    Bytes out;
    return step(exchange_->on_silence(out), out);
  }

  // The same exchange up to now, since an exchange cannot be copied.
  [[nodiscard]] std::unique_ptr<ExchangeText> again() const {
    auto same = std::make_unique<ExchangeText>(make_, explain_);
    if (!device_.empty()) (void)same->device(device_);
    (void)same->begin(begun_);
    for (const Bytes& bytes : before_)
      (void)(bytes.empty() ? same->silence() : same->received(bytes));
    return same;
  }

  static char letter(Cause cause) {
    switch (cause) {
      case Cause::kNoResponse: return 'N';
      case Cause::kTruncated: return 'T';
      case Cause::kChecksum: return 'C';
      case Cause::kMalformed: return 'M';
      case Cause::kForeign: return 'F';
      case Cause::kOverlong: return 'O';
      case Cause::kDeviceError: return 'E';
      case Cause::kDeviceBusy: return 'B';
      default: return '?';
    }
  }

  // The sign of what arrives, see above. `missing`: what a wait for the rest of a frame expects.
  char sign_of(const Bytes& bytes, const std::string& right,
               std::uint32_t* missing = nullptr) const {
    const auto same = again();
    append(same->received_, bytes);
    Bytes out;
    Step step =
        bytes.empty() ? Step::need_response() : same->exchange_->on_bytes(same->received_, out);
    const bool waited = step.kind == Step::Kind::kNeedMore;
    if (missing != nullptr && waited && step.wait == Wait::kRestOfFrame) *missing = step.characters;
    if (waited) step = same->exchange_->on_silence(out);
    if (step.kind == Step::Kind::kSend) return '>';
    if (step.kind == Step::Kind::kNeedMore) return '.';
    if (step.kind == Step::Kind::kDone) return same->step(step, out) == right ? '=' : '*';
    const char failure = letter(step.cause);
    return waited ? static_cast<char>(failure - 'A' + 'a') : failure;
  }

  std::string damaged(const Bytes& whole) const {
    if (!exchange_) return "  !! no exchange\n";
    const std::string right = again()->received(whole);
    std::string cut, lost, doubled, by_01, by_10, missing;
    std::string run;
    std::size_t times = 0;
    const auto end_run = [&] {
      if (times != 0) missing += ' ' + run + (times > 1 ? " x " + std::to_string(times) : "");
    };
    for (std::size_t at = 0; at < whole.size(); ++at) {
      const auto before = whole.begin(), here = before + static_cast<std::ptrdiff_t>(at);
      std::uint32_t more = 0;
      cut += sign_of(Bytes(before, here), right, &more);
      const std::string wanted = more == 0 ? "-" : std::to_string(more);
      if (wanted != run) end_run(), times = 0, run = wanted;
      ++times;
      Bytes changed = whole;
      changed.erase(changed.begin() + (here - before));
      lost += sign_of(changed, right);
      changed = whole;
      changed.insert(changed.begin() + (here - before), *here);
      doubled += sign_of(changed, right);
      changed = whole;
      changed[at] ^= 0x01u;
      by_01 += sign_of(changed, right);
      changed[at] ^= 0x11u;
      by_10 += sign_of(changed, right);
    }
    end_run();
    Bytes twice = whole, behind_noise{0x00};
    append(twice, whole);
    append(behind_noise, whole);
    return "  cut     " + cut + "\n  missing" + missing + "\n  lost    " + lost + "\n  doubled " +
           doubled + "\n  by 01   " + by_01 + "\n  by 10   " + by_10 + "\n  twice " +
           sign_of(twice, right) + ", behind noise " + sign_of(behind_noise, right) + '\n';
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
  Bytes received_;             // since the last send
  std::string device_;         // the text of the last device
  std::string begun_;          // the request of the exchange
  std::vector<Bytes> before_;  // what arrived since then; empty: a silence
};

}  // namespace fieldcast::test
