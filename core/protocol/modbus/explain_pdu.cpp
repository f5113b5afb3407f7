#include "core/protocol/modbus/explain_pdu.hpp"

#include <algorithm>
#include <array>
#include <string>

#include "core/protocol/modbus/areas.hpp"

namespace fieldcast::modbus {
namespace {

std::string hex16(std::uint16_t value) {
  const std::uint8_t bytes[]{static_cast<std::uint8_t>(value >> 8),
                             static_cast<std::uint8_t>(value)};
  return to_hex(bytes, '\0');
}
std::string hex8(std::uint8_t value) { return to_hex({&value, 1}, '\0'); }
std::string number(std::size_t value) { return std::to_string(value); }

bool reads_bits(std::uint8_t function) { return function == 1 || function == 2; }

class PduExplainer {
 public:
  PduExplainer(ByteView pdu, FieldWriter& writer) : pdu_(pdu), writer_(writer) {}

  void run() {
    if (pdu_.empty()) return writer_.remark("", "the function is missing");
    const std::uint8_t function = pdu_[0];
    if ((function & kExceptionFlag) != 0) return exception();
    const bool known = function_text(function) != "unknown function";
    writer_.add(0, 1, "function", hex8(function) + " " + std::string(function_text(function)),
                known ? "" : "no function of the standard");
    switch (function) {
      case 1:
      case 2:
      case 3:
      case 4: return read();
      case 5: return fixed_write("value", coil_fault());
      case 6: return fixed_write("value", {});
      case 15:
      case 16: return write_multiple();
      case 20: return read_file();
      case 21: return write_file();
      case 22: return mask_write();
      case 23: return read_write();
      case 24: return read_queue();
      case 43: return has(1, 1) && pdu_[1] == 0x0E ? identity() : other();
      default: return other();
    }
  }

 private:
  bool has(std::size_t at, std::size_t count) const { return pdu_.size() >= at + count; }

  void word(std::size_t at, const std::string& name, const std::string& comment = {},
            const std::string& fault = {}) {
    if (!has(at, 2))
      return writer_.add(std::min(at, pdu_.size()), pdu_.size() - std::min(at, pdu_.size()), name,
                         "", "missing");
    const std::uint16_t value = read_u16(pdu_, at);
    writer_.add(at, 2, name,
                hex16(value) + " = " + number(value) + (comment.empty() ? "" : ", " + comment),
                fault);
  }

  void address(std::size_t at, const std::string& name) {
    const std::string where =
        has(at, 2) ? std::string(row_of_function(pdu_[0]).area) + ":" + number(read_u16(pdu_, at))
                   : "";
    word(at, name, where);
  }

  std::string quantity_fault(std::size_t at, std::size_t limit) const {
    if (!has(at, 2)) return {};
    const std::size_t quantity = read_u16(pdu_, at);
    if (quantity == 0 || quantity > limit) return "must be 1.." + number(limit);
    if (read_u16(pdu_, at - 2) + quantity > 65536) return "reaches beyond address 65535";
    return {};
  }

  void trailing(std::size_t end) {
    if (pdu_.size() > end)
      writer_.add(end, pdu_.size() - end, "surplus", to_hex(pdu_.subspan(end)),
                  "bytes behind the end");
  }

  void exception() {
    const auto function = static_cast<std::uint8_t>(pdu_[0] & ~kExceptionFlag);
    writer_.remark("exception response");
    writer_.add(0, 1, "function",
                hex8(pdu_[0]) + " refused: " + std::string(function_text(function)));
    if (!has(1, 1)) return writer_.add(1, 0, "exception", "", "missing");
    const bool known = exception_text(pdu_[1]) != "unknown exception";
    writer_.add(1, 1, "exception", hex8(pdu_[1]) + " " + std::string(exception_text(pdu_[1])),
                known ? "" : "no code of the standard");
    trailing(2);
  }

  // A request has 5 bytes; a response contains its own length.
  void read() {
    const bool request_fits =
        pdu_.size() == 5 && quantity_fault(3, row_of_function(pdu_[0]).most).empty();
    const bool response_fits = has(1, 1) && pdu_.size() == 2u + pdu_[1] && pdu_[1] != 0 &&
                               (reads_bits(pdu_[0]) || pdu_[1] % 2 == 0);
    if (request_fits && response_fits)
      writer_.remark("request; could also be a response of " + number(pdu_[1]) + " bytes");
    else
      writer_.remark(request_fits || (!response_fits && pdu_.size() == 5) ? "request" : "response");
    if (request_fits || (!response_fits && pdu_.size() == 5)) {
      address(1, "first");
      return word(3, "quantity", {}, quantity_fault(3, row_of_function(pdu_[0]).most));
    }
    counted_data(1, reads_bits(pdu_[0]));
  }

  void counted_data(std::size_t at, bool bits) {
    if (!has(at, 1)) return writer_.add(pdu_.size(), 0, "byte count", "", "missing");
    const std::size_t count = pdu_[at];
    const std::size_t present = pdu_.size() - at - 1;
    std::string fault;
    if (count != present)
      fault = number(present) + " bytes follow";
    else if (count == 0)
      fault = "no data";
    else if (!bits && count % 2 != 0)
      fault = "registers have two bytes each";
    writer_.add(at, 1, "byte count", number(count), fault);
    data(at + 1, std::min(count, present), bits);
    trailing(at + 1 + std::min(count, present));
  }

  void data(std::size_t at, std::size_t size, bool bits) {
    writer_.deeper();
    if (bits) {
      for (std::size_t i = 0; i < size; ++i) {
        std::string text;
        for (unsigned bit = 0; bit < 8; ++bit) text += (pdu_[at + i] >> bit & 1) != 0 ? "1 " : "0 ";
        text.pop_back();
        writer_.add(at + i, 1, "bits +" + number(8 * i) + ".." + number(8 * i + 7),
                    hex8(pdu_[at + i]) + " = " + text);
      }
    } else {
      for (std::size_t i = 0; i + 1 < size; i += 2) word(at + i, "register +" + number(i / 2));
      if (size % 2 != 0)
        writer_.add(at + size - 1, 1, "half a register", hex8(pdu_[at + size - 1]),
                    "one byte too few");
    }
    writer_.higher();
  }

  std::string coil_fault() const {
    if (!has(3, 2) || read_u16(pdu_, 3) == 0x0000 || read_u16(pdu_, 3) == 0xFF00) return {};
    return "a coil is written FF00 (on) or 0000 (off)";
  }

  void fixed_write(const std::string& name, const std::string& fault) {
    writer_.remark("request or its response: both have the same bytes");
    address(1, "address");
    word(3, name, {}, fault);
    trailing(5);
  }

  void write_multiple() {
    const bool bits = pdu_[0] == 15;
    const bool response = pdu_.size() <= 5;
    writer_.remark(response ? "response" : "request");
    address(1, "first");
    word(3, "quantity", {}, quantity_fault(3, row_of_function(pdu_[0]).most));
    if (response) return;
    const std::size_t quantity = read_u16(pdu_, 3);
    const std::size_t needed = bits ? (quantity + 7) / 8 : quantity * 2;
    if (pdu_[5] != needed)
      writer_.remark(
          "", "the byte count is " + number(pdu_[5]) + ", the quantity needs " + number(needed));
    counted_data(5, bits);
  }

  void mask_write() {
    writer_.remark("request or its response: both have the same bytes");
    address(1, "address");
    word(3, "and mask");
    word(5, "or mask", "new = (old AND and) OR (or AND NOT and)");
    trailing(7);
  }

  void read_write() {
    const bool response = has(1, 1) && pdu_.size() == 2u + pdu_[1] && pdu_[1] % 2 == 0;
    const bool request = pdu_.size() == request_pdu_size(pdu_);
    if (response && !request) {
      writer_.remark("response");
      return counted_data(1, false);
    }
    writer_.remark(response ? "request; could also be a response" : "request");
    address(1, "read first");
    word(3, "read quantity", {}, quantity_fault(3, kMaxReadRegisters));
    address(5, "write first");
    word(7, "write quantity", {}, quantity_fault(7, kMaxReadWriteRegisters));
    if (!has(9, 1)) return writer_.add(pdu_.size(), 0, "byte count", "", "missing");
    if (pdu_[9] != read_u16(pdu_, 7) * 2)
      writer_.remark("", "the byte count does not match the write quantity");
    counted_data(9, false);
  }

  void file_count() {
    if (!has(1, 1)) return writer_.add(1, 0, "byte count", "", "missing");
    const std::size_t present = pdu_.size() - 2;
    writer_.add(1, 1, "byte count", number(pdu_[1]),
                pdu_[1] == present ? "" : number(present) + " bytes follow");
  }

  void reference(std::size_t at) {
    writer_.add(at, 1, "reference", number(pdu_[at]), pdu_[at] == 6 ? "" : "must be 6");
  }

  // Returns the end of the group, or of its registers in a write.
  std::size_t group(std::size_t at) {
    if (!has(at, kGroupBytes)) {
      writer_.add(at, pdu_.size() - at, "group", to_hex(pdu_.subspan(at)), "7 bytes are needed");
      return pdu_.size();
    }
    const std::size_t file = read_u16(pdu_, at + 1), record = read_u16(pdu_, at + 3);
    const std::size_t quantity = read_u16(pdu_, at + 5);
    reference(at);
    word(at + 1, "file", {}, file == 0 ? "must be 1..65535" : "");
    word(at + 3, "record", "file:" + number(file) + ":" + number(record),
         record < kRecords ? "" : "must be 0..9999");
    const bool within = record + quantity <= kRecords;
    const std::string end = within ? "" : "reaches beyond record 9999";
    word(at + 5, "quantity", {}, quantity == 0 ? "must not be 0" : end);
    if (pdu_[0] == 20) return at + kGroupBytes;
    const std::size_t present = pdu_.size() - at - kGroupBytes;
    if (2 * quantity > present)
      writer_.remark("", "the quantity needs " + number(2 * quantity) + " bytes, " +
                             number(present) + " follow");
    data(at + kGroupBytes, std::min(2 * quantity, present), false);
    return at + kGroupBytes + std::min(2 * quantity, present);
  }

  void groups() {
    file_count();
    if (pdu_.size() == 2) writer_.remark("", "no group");
    for (std::size_t at = 2; at < pdu_.size();) at = group(at);
  }

  bool has_file_data() const {
    std::size_t at = 2;
    while (has(at, 2) && pdu_[at + 1] == 6 && pdu_[at] % 2 == 1) at += std::size_t{1} + pdu_[at];
    return at > 2 && at == pdu_.size();
  }

  void read_file() {
    // A group of a request begins with the reference type 6, a response with an odd length.
    const bool response = has_file_data();
    writer_.remark(response ? "response" : "request");
    if (!response) return groups();
    file_count();
    for (std::size_t at = 2; at < pdu_.size(); at += std::size_t{1} + pdu_[at]) {
      writer_.add(at, 1, "group length", number(pdu_[at]));
      reference(at + 1);
      data(at + 2, pdu_[at] - std::size_t{1}, false);
    }
  }

  void write_file() {
    writer_.remark("request or its response: both have the same bytes");
    groups();
  }

  void read_queue() {
    const bool request = pdu_.size() <= 3;
    writer_.remark(request ? "request" : "response");
    if (request) return address(1, "pointer");
    const std::size_t present = pdu_.size() - 3;
    word(1, "byte count", {},
         read_u16(pdu_, 1) == present ? "" : number(present) + " bytes follow");
    const std::size_t queued = has(3, 2) ? read_u16(pdu_, 3) : 0;
    const bool fits = 2 * queued + 2 == present;
    word(3, "queued", {},
         queued > kMaxQueued ? "must be 0..31"
         : fits              ? ""
                             : "the byte count does not match");
    const std::size_t shown =
        std::min(2 * queued, pdu_.size() - std::min<std::size_t>(5, pdu_.size()));
    data(5, shown, false);
    trailing(5 + shown);
  }

  // Read Device Identification, V1.1b3, 6.21.
  void identity() {
    static constexpr std::array<std::string_view, 4> kCodes{"basic objects", "regular objects",
                                                            "extended objects", "one object"};
    writer_.remark(pdu_.size() <= 4 ? "request" : "response");
    writer_.add(1, 1, "MEI type", hex8(pdu_[1]) + " read device identification");
    if (!has(2, 2)) return writer_.add(2, 0, "code", "", "missing");
    const bool known = pdu_[2] >= 1 && pdu_[2] <= kCodes.size();
    writer_.add(2, 1, "code",
                hex8(pdu_[2]) + (known ? " " + std::string(kCodes[pdu_[2] - 1u]) : ""),
                known ? "" : "must be 01..04");
    if (pdu_.size() == 4) return writer_.add(3, 1, "object", object_text(pdu_[3]));
    const unsigned level = pdu_[3] & 0x7Fu;
    writer_.add(3, 1, "conformity", hex8(pdu_[3]),
                level >= 1 && level <= 3 ? "" : "must be 01..03 or 81..83");
    if (!has(4, 3)) return writer_.add(4, 0, "objects", "", "missing");
    writer_.add(4, 1, "more", hex8(pdu_[4]) + (pdu_[4] == 0 ? " no" : " yes"),
                pdu_[4] == 0 || pdu_[4] == 0xFF ? "" : "must be 00 or FF");
    writer_.add(5, 1, "next object", number(pdu_[5]));
    writer_.add(6, 1, "objects", number(pdu_[6]));
    objects(7);
  }

  static std::string object_text(std::uint8_t object) {
    static constexpr std::array<std::string_view, 7> kNames{
        "vendor",       "product code", "revision",        "vendor URL",
        "product name", "model name",   "user application"};
    return "id:" + number(object) +
           (object < kNames.size() ? ", " + std::string(kNames[object]) : "");
  }

  void objects(std::size_t at) {
    writer_.deeper();
    for (unsigned left = pdu_[6]; left > 0; --left) {
      if (!has(at, 2)) {
        writer_.add(at, pdu_.size() - at, "object", "", "missing");
        break;
      }
      const std::size_t length = pdu_[at + 1], present = pdu_.size() - at - 2;
      writer_.add(at, 1, "object", object_text(pdu_[at]));
      writer_.add(at + 1, 1, "length", number(length),
                  length <= present ? "" : number(present) + " bytes follow");
      const std::size_t shown = std::min(length, present);
      writer_.add(at + 2, shown, "text", printable(pdu_.subspan(at + 2, shown)));
      at += 2 + shown;
    }
    writer_.higher();
    trailing(at);
  }

  // Unused by Fieldcast: only a length fixed by the standard is checked.
  void other() {
    const bool has_length = response_pdu_size(pdu_) != 0 || request_pdu_size(pdu_) != 0;
    const bool fits = pdu_.size() == response_pdu_size(pdu_) ||
                      pdu_.size() == request_pdu_size(pdu_) || pdu_[0] == 8 || pdu_[0] == 43;
    const bool cut = pdu_[0] == 8 && pdu_.size() < 5;
    writer_.add(
        1, pdu_.size() - 1, "data", to_hex(pdu_.subspan(1)),
        (has_length && !fits) || cut ? "the length of neither a request nor a response" : "");
  }

  const ByteView pdu_;
  FieldWriter& writer_;
};

}  // namespace

void explain_pdu(ByteView pdu, FieldWriter& writer) { PduExplainer(pdu, writer).run(); }

std::string unit_text(std::uint8_t unit, bool serial) {
  const std::string text = std::to_string(unit);
  if (serial && unit == 0) return text + ": broadcast";
  if (serial && unit > 247) return text + ": reserved on serial lines";
  return text;
}

}  // namespace fieldcast::modbus
