#include "tools/sim/families/mc_serial_device.hpp"

#include <algorithm>
#include <string>

#include "core/codec/checksum.hpp"

namespace fieldcast::sim {
namespace {

constexpr std::uint8_t kStx = 0x02, kEtx = 0x03, kEnq = 0x05, kAck = 0x06, kDle = 0x10, kNak = 0x15;
constexpr std::size_t kMostReceived = 8500;
constexpr std::uint16_t kUnknownCommand = 0x7F22, kWrongEnd = 0x7F23, kWrongSum = 0x7F24;
constexpr std::uint16_t kShortSum = 0x02, kShortEnd = 0x03, kShortArea = 0x06, kShortDigit = 0x07;

std::string option(const DeviceSetup& setup, const std::string& name,
                   const std::string& otherwise) {
  const auto found = setup.spec.link.options.find(name);
  return found == setup.spec.link.options.end() ? otherwise : found->second;
}

// The code of a 1C frame for one of the other frames.
std::uint16_t short_code(std::uint16_t code) {
  return code == kWrongSum ? kShortSum : code == kWrongEnd ? kShortEnd : kShortArea;
}

// The code of the serial module for one of the Ethernet module.
std::uint16_t module_code(std::uint16_t code) {
  switch (code) {
    case 0xC050:
    case 0xC060: return 0x7F20;
    case 0xC051:
    case 0xC052: return 0x7E42;
    case 0xC053:
    case 0xC054: return 0x7E41;
    case 0xC059: return kUnknownCommand;
    case 0xC05B: return 0x7E43;
    case 0xC05C: return 0x7164;
    case 0xC061: return kWrongEnd;
    default: return code;
  }
}

Bytes header_of(const DeviceSetup& setup, bool binary) {
  Bytes header;
  const auto number = [&](std::uint64_t value, unsigned bytes) {
    if (!binary) return append_hex(header, value, 2 * bytes);
    for (; bytes > 0; --bytes, value >>= 8) header.push_back(static_cast<std::uint8_t>(value));
  };
  const auto named = [&](const char* name, unsigned otherwise) {
    return address_number(option(setup, name, std::to_string(otherwise))).value_or(0);
  };
  const std::string frame = option(setup, "frame", "4c");
  const bool is_4c = frame == "4c", is_1c = frame == "1c";
  if (!is_1c) number(is_4c ? 0xF8 : 0xF9, 1);
  number(setup.spec.link.address, 1);
  if (!is_1c) number(named("network", 0), 1);
  number(named("pc", 255), 1);
  if (is_1c) return header;
  if (is_4c) {
    number(named("module", 1023), 2);
    number(named("unit", 0), 1);
  }
  number(named("own-station", 0), 1);
  return header;
}

// The request of a 1C frame: command(2) wait(1) device(5, of J and Q 7) points(2) data
struct ShortRequest {
  explicit ShortRequest(ByteView content)
      : command(content.begin(), content.begin() + 2),
        bits(command[0] == 'B' || command[0] == 'J'),
        write(command[1] == 'W'),
        fixed(command[0] == 'J' || command[0] == 'Q' ? 12 : 10) {}
  [[nodiscard]] bool known() const {
    return std::string_view("BWJQ").find(command[0]) != std::string_view::npos &&
           (write || command[1] == 'R');
  }
  const std::string command;
  const bool bits, write;
  const std::size_t fixed;  // characters up to the points, inclusive
};

// The bytes between 10 02 and 10 03; empty before 10 03.
std::optional<Bytes> between_marks(ByteView bytes, std::size_t& end) {
  Bytes text;
  for (end = 2; end + 1 < bytes.size(); ++end) {
    if (bytes[end] == kDle && bytes[end + 1] == kEtx) {
      end += 2;
      return text;
    }
    if (bytes[end] == kDle) ++end;
    text.push_back(bytes[end]);
  }
  return std::nullopt;
}

}  // namespace

class McSerialDevice::Line : public GapReceiver {
 public:
  explicit Line(McSerialDevice& device) : GapReceiver(device.line_, kStreamGap), device_(device) {}

  void on_character(std::uint8_t character, Instant end, Reaction& reaction) override {
    heard(end, reaction);
    if (device_.binary_ ? !begins_binary(character) : !begins_ascii(character)) return;
    const bool whole = device_.binary_
                           ? device_.take_binary(received_, end, reaction)
                           : device_.take_ascii(ByteView(received_).subspan(1), end, reaction);
    if (whole || received_.size() > kMostReceived) received_.clear();
  }
  void on_silence(Instant, Reaction& reaction) override {
    if (!device_.binary_ && !received_.empty())
      device_.refuse_unknown(ByteView(received_).subspan(1), reaction);
    ready(false);
  }

 private:
  // Both return false if the character is not part of a request.
  bool begins_ascii(std::uint8_t character) {
    const bool begins = character == (device_.enclosed_ ? kStx : kEnq);
    if (begins) received_.clear();
    if (!begins && received_.empty()) return false;
    received_.push_back(character);
    return true;
  }
  bool begins_binary(std::uint8_t character) {
    if (received_.size() == 1 && character != kStx) received_.clear();
    if (received_.empty() && character != kDle) return false;
    received_.push_back(character);
    return received_.size() > 2;
  }

  McSerialDevice& device_;
};

McSerialDevice::McSerialDevice(const DeviceSetup& setup)
    : McDevice(setup, option(setup, "format", "1") != "5"),
      binary_(!ascii_),
      numbered_(option(setup, "format", "1") == "2"),
      enclosed_(option(setup, "format", "1") == "3"),
      line_end_(option(setup, "format", "1") == "4"),
      sum_check_(option(setup, "sum-check", "true") == "true"),
      short_(option(setup, "frame", "4c") == "1c"),
      octal_(option(setup, "commands", "a") == "fx"),
      header_(header_of(setup, binary_)) {}

std::unique_ptr<Receiver> McSerialDevice::open_receiver() { return std::make_unique<Line>(*this); }

std::optional<std::size_t> McSerialDevice::length_of(ByteView content) const {
  if (content.size() < 8) return std::nullopt;
  if (short_) {
    const ShortRequest request(content);
    if (!request.known()) return 0;
    if (content.size() < request.fixed) return std::nullopt;
    const auto points = number_in(content.subspan(request.fixed - 2, 2));
    if (!points) return 0;
    const std::size_t each = !request.write ? 0 : request.bits ? 1 : 4;
    return request.fixed + (*points == 0 ? 256 : *points) * each;
  }
  const auto command = number_in(content.first(4)), subcommand = number_in(content.subspan(4, 4));
  if (!command || !subcommand || *subcommand > 3) return 0;
  const std::size_t device = *subcommand < 2 ? 8 : 12;
  const bool batch = *command == 0x0401 || *command == 0x1401;
  if (!batch && *command != 0x0403) return 0;
  const std::size_t counts = batch ? 8 + device : 8;
  if (content.size() < counts + 4) return std::nullopt;
  const auto points = number_in(content.subspan(counts, batch ? 4 : 2));
  const auto doubles = batch ? 0 : number_in(content.subspan(counts + 2, 2));
  if (!points || !doubles) return 0;
  if (!batch) return counts + 4 + (*points + *doubles) * device;
  const std::size_t each = *command == 0x0401 ? 0 : *subcommand % 2 != 0 ? 1 : 4;
  return counts + 4 + *points * each;
}

bool McSerialDevice::take_ascii(ByteView text, Instant now, Reaction& reaction) {
  const std::size_t begin = content_begin();
  if (text.size() < begin) return false;
  if (!std::ranges::equal(text.first(begin).last(header_.size()), header_)) return true;
  const ByteView block = text.first(begin - header_.size());
  block_.assign(block.begin(), block.end());
  const auto length = length_of(text.subspan(begin));
  if (!length || *length == 0) return false;
  const std::size_t summed = begin + *length + (enclosed_ ? 1 : 0);
  const std::size_t sum = sum_check_ ? 2 : 0, end = line_end_ ? 2 : 0;
  if (text.size() < summed + sum + end) return false;
  const ByteView digits = text.subspan(summed, sum), marks = text.subspan(summed + sum, end);
  if (sum_check_ && number_in(digits) != sum8(text.first(summed)))
    respond({kWrongSum, {}}, reaction);
  else if ((line_end_ && (marks[0] != '\r' || marks[1] != '\n')) ||
           (enclosed_ && text[summed - 1] != kEtx))
    respond({kWrongEnd, {}}, reaction);
  else
    respond(execute(text.subspan(begin, *length), now), reaction);
  return true;
}

void McSerialDevice::refuse_unknown(ByteView text, Reaction& reaction) {
  if (text.size() >= content_begin() && length_of(text.subspan(content_begin())) == 0)
    respond({kUnknownCommand, {}}, reaction);
}

bool McSerialDevice::take_binary(ByteView bytes, Instant now, Reaction& reaction) {
  std::size_t end = 0;
  const auto text = between_marks(bytes, end);
  if (!text || bytes.size() < end + (sum_check_ ? 2 : 0)) return false;
  const ByteView whole(*text);
  if (whole.size() < 2 + header_.size() + 4) return true;
  const ByteView content = whole.subspan(2 + header_.size());
  const bool is_response = content[0] == 0xFF && content[1] == 0xFF;  // of another PLC
  if (is_response || !std::ranges::equal(whole.subspan(2, header_.size()), header_)) return true;
  const std::size_t count = whole[0] | static_cast<std::size_t>(whole[1]) << 8;
  if (sum_check_ && number_in(bytes.subspan(end, 2)) != sum8(whole))
    respond({kWrongSum, {}}, reaction);
  else if (count != whole.size() - 2)
    respond({kWrongEnd, {}}, reaction);
  else
    respond(run(content, now), reaction);
  return true;
}

McDevice::Result McSerialDevice::execute(ByteView content, Instant now) {
  return short_ ? run_short(content, now) : run(content, now);
}

McDevice::Result McSerialDevice::run_short(ByteView content, Instant now) {
  const ShortRequest request(content);
  ++statistics_.requests[request.command];
  const ByteView device = content.subspan(3, request.fixed - 5);
  const std::size_t letters = device[1] > '9' && device[0] != 'W' && device[0] != 'B' ? 2 : 1;
  const std::string name(device.begin(), device.begin() + static_cast<std::ptrdiff_t>(letters));
  Bytes digits(device.begin() + static_cast<std::ptrdiff_t>(letters), device.end());
  if (octal_ && (name == "X" || name == "Y")) {
    const auto number = number_in(digits, 8);
    digits.clear();
    if (number) append_hex(digits, *number, 4);
  }
  const auto place = place_at(name, digits);
  const auto points = number_in(content.subspan(request.fixed - 2, 2));
  if (!place || !points) return {kShortArea, {}};
  const auto count = static_cast<std::uint32_t>(*points == 0 ? 256 : *points);
  const std::uint32_t most = !request.bits ? 64 : request.write ? 160 : 256;
  if (count > most) return {kShortArea, {}};
  const std::uint16_t refused =
      request.bits ? refusal_of_bits(*place, count) : refusal_of_words(*place, count);
  if (refused != 0) return {kShortArea, {}};
  return request.write ? write_short(*place, request.bits, count, content.subspan(request.fixed))
                       : read_short(*place, request.bits, count, now);
}

McDevice::Result McSerialDevice::read_short(const Place& place, bool bits, std::uint32_t points,
                                            Instant now) const {
  Result result;
  for (std::uint32_t i = 0; i < points; ++i) {
    if (bits)
      append_hex(result.data, memory_.read(place.area, place.number + i, now), 1);
    else
      append_hex(result.data, word(place, i, now), 4);
  }
  return result;
}

McDevice::Result McSerialDevice::write_short(const Place& place, bool bits, std::uint32_t points,
                                             ByteView data) {
  std::vector<std::uint32_t> values;
  const std::size_t each = bits ? 1 : 4;
  for (std::uint32_t i = 0; i < points; ++i) {
    const auto value = number_in(data.subspan(i * each, each), bits ? 2 : 16);
    if (!value) return {kShortDigit, {}};
    values.push_back(static_cast<std::uint32_t>(*value));
  }
  for (std::uint32_t i = 0; i < points; ++i) {
    if (bits)
      memory_.write(place.area, place.number + i, values[i], statistics_);
    else
      store_word(place, i, values[i]);
  }
  ++statistics_.write_requests;
  return {};
}

void McSerialDevice::respond(const Result& result, Reaction& reaction) {
  ++statistics_.responses;
  Result own{module_code(result.end), result.end == 0 ? result.data : Bytes{}};
  if (own.end == kWrongSum || own.end == kWrongEnd) ++statistics_.bad_frames;
  if (short_ && own.end > 0xFF) own.end = short_code(own.end);
  if (own.end != 0) ++statistics_.exceptions[own.end];
  if (binary_)
    respond_binary(own, reaction.response);
  else
    respond_ascii(own, reaction.response);
}

void McSerialDevice::respond_ascii(const Result& result, Bytes& out) const {
  const bool refused = result.end != 0, has_data = !result.data.empty();
  out.push_back(enclosed_ || has_data ? kStx : refused ? kNak : kAck);
  append(out, block_);
  append(out, header_);
  const std::string_view end_code = refused ? (short_ ? "NN" : "QNAK") : (short_ ? "GG" : "QACK");
  if (enclosed_) out.insert(out.end(), end_code.begin(), end_code.end());
  if (refused) append_hex(out, result.end, short_ ? 2 : 4);
  append(out, result.data);
  if (enclosed_ || has_data) out.push_back(kEtx);
  if (has_data && sum_check_) append_hex(out, sum8(ByteView(out).subspan(1)), 2);
  if (!line_end_) return;
  out.push_back('\r');
  out.push_back('\n');
}

void McSerialDevice::respond_binary(const Result& result, Bytes& out) const {
  Bytes text;
  append_field(text, header_.size() + 4 + result.data.size(), 2);
  append(text, header_);
  append_field(text, 0xFFFF, 2);
  append_field(text, result.end, 2);
  append(text, result.data);
  out = {kDle, kStx};
  for (const std::uint8_t byte : text) {
    out.push_back(byte);
    if (byte == kDle) out.push_back(kDle);
  }
  out.push_back(kDle);
  out.push_back(kEtx);
  if (sum_check_) append_hex(out, sum8(text), 2);
}

tl::expected<std::unique_ptr<SimDevice>, std::string> make_mc_serial_device(
    const DeviceSetup& setup) {
  const bool octal = option(setup, "commands", "a") == "fx";
  const auto parse = [octal](std::string_view at) {
    auto address = parse_mc_address(at);
    if (address && octal && (at.starts_with('X') || at.starts_with('Y'))) {
      const auto number = number_in(at.substr(1), 8);
      if (!number) return std::optional<ItemAddress>{};
      address->first = static_cast<std::uint32_t>(*number);
    }
    return address;
  };
  return make_memory_device<McSerialDevice>(setup, 31, parse, "station");
}

}  // namespace fieldcast::sim
