#include "tools/sim/families/hostlink_device.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "core/codec/checksum.hpp"
#include "tools/sim/device/device.hpp"

namespace fieldcast::sim {
namespace {

constexpr std::size_t kMostCMode = 131, kMostFins = 1114;  // characters including CR
constexpr std::size_t kReadFirst = 120, kReadLater = 124, kFlagsFirst = 121, kFlagsLater = 124,
                      kWriteLater = 124;

// CR ends a frame; `@` starts one at any position. Also receives the lines of other stations.
class HostLinkReceiver : public Receiver {
 public:
  explicit HostLinkReceiver(HostLinkDevice& device) : device_(device) {}
  void on_character(std::uint8_t character, Instant end, Reaction& reaction) override {
    if (character == '@') line_.clear();
    if (character == '\r') {
      device_.take(line_, end, reaction);
      line_.clear();
    } else if (line_.size() <= kMostFins) {
      line_.push_back(character);
    }
  }

 private:
  HostLinkDevice& device_;
  Bytes line_;
};

Bytes framed(std::string_view text, bool last) {
  Bytes frame(text.begin(), text.end());
  append_hex(frame, xor8(frame), 2);
  if (last) frame.push_back('*');
  frame.push_back('\r');
  return frame;
}

ByteView view(std::string_view text) {
  return {reinterpret_cast<const std::uint8_t*>(text.data()), text.size()};
}

std::string decimal(unsigned number) {
  return {static_cast<char>('0' + number / 10), static_cast<char>('0' + number % 10)};
}

std::string hex(std::uint64_t number, unsigned digits) {
  Bytes text;
  append_hex(text, number, digits);
  return {text.begin(), text.end()};
}

bool is_served(char letter) {
  return std::ranges::any_of(kOmronAreas,
                             [&](const OmronArea& area) { return area.letter == letter; });
}

std::size_t address_digits(char letter) { return letter == 'E' ? 6 : 4; }

}  // namespace

HostLinkDevice::HostLinkDevice(const DeviceSetup& setup)
    : MemoryDevice({omron_areas(), setup}),
      unit_(setup.spec.link.address),
      fins_(memory_, statistics_) {}

std::unique_ptr<Receiver> HostLinkDevice::open_receiver() {
  return std::make_unique<HostLinkReceiver>(*this);
}

void HostLinkDevice::forget_transfer() {
  later_frames_.clear();
  writing_.clear();
}

Bytes HostLinkDevice::respond(std::string_view header, std::string_view end_code,
                              std::string_view text) {
  if (!end_code.empty() && end_code != "00")
    ++statistics_.exceptions[static_cast<unsigned>(*number_in(end_code, 16))];
  ++statistics_.responses;
  return framed(fmt::format("@{}{}{}{}", decimal(unit_), header, end_code, text), true);
}

void HostLinkDevice::take(ByteView line, Instant now, Reaction& reaction) {
  if (!line.empty() && line[0] == '@') return take_command(line, now, reaction);
  if (!writing_.empty()) return take_write_part(line, reaction);
  if (later_frames_.empty()) return;
  reaction.response = later_frames_.front();  // any line counts as the delimiter
  later_frames_.pop_front();
}

void HostLinkDevice::take_command(ByteView line, Instant now, Reaction& reaction) {
  if (std::string_view(reinterpret_cast<const char*>(line.data()), line.size()) == "@**")
    return forget_transfer();
  const auto unit = line.size() >= 5 ? number_in(line.subspan(1, 2), 10) : std::nullopt;
  if (unit != unit_) return forget_transfer();
  const std::string header(line.begin() + 3, line.begin() + 5);
  const bool abort = header == "XZ";
  if (!later_frames_.empty() && !abort) {  // any other command counts as a delimiter
    reaction.response = later_frames_.front();
    later_frames_.pop_front();
    return;
  }
  forget_transfer();
  const bool last = line.back() == '*';
  const std::size_t end = line.size() - (last ? 1 : 0);
  if (end < 7) {
    ++statistics_.bad_frames;
    return;
  }
  if (number_in(line.subspan(end - 2, 2)) != xor8(line.first(end - 2))) {
    ++statistics_.bad_frames;
    reaction.response = respond(header, "13");
    return;
  }
  if (abort) return;
  const Command command{
      header, std::string(line.begin() + 5, line.begin() + static_cast<std::ptrdiff_t>(end) - 2),
      last};
  ++statistics_.requests[header];
  if (header == "FA") {
    reaction.response =
        line.size() + 1 > kMostFins ? respond(header, "18") : fins(command, now, reaction.pause);
  } else {
    reaction.response =
        line.size() + 1 > kMostCMode ? respond(header, "18") : execute(command, now);
  }
}

Bytes HostLinkDevice::execute(const Command& command, Instant now) {
  const std::string& header = command.header;
  const bool known = is_served(header[1]);
  if (header[0] == 'W' && known) return begin_write(command);
  if (!command.last) return respond(header, "14");
  if (header[0] == 'R' && known) return read(command, now);
  if (header == "TS") return respond(header, "", command.text);
  if (header == "MM") return respond(header, "00", "30");
  if (header == "MS")
    return respond(header, "00", mode_ == 0 ? "00A8" : mode_ == 2 ? "03A8" : "02A8");
  if (header == "SC") {
    const auto mode = number_in(command.text, 16);
    if (command.text.size() != 2) return respond(header, "14");
    if (!mode || (*mode != 0 && *mode != 2 && *mode != 3)) return respond(header, "15");
    mode_ = static_cast<unsigned>(*mode);
    return respond(header, "00");
  }
  return respond("IC", "");
}

tl::expected<HostLinkDevice::Address, std::string> HostLinkDevice::address_of(
    char letter, std::string_view digits, std::uint32_t count) const {
  const auto bank =
      letter == 'E' ? number_in(digits.substr(0, 2), 16) : std::optional<std::uint64_t>(0);
  const auto number = number_in(digits.substr(digits.size() - 4), 10);
  if (!bank || !number) return tl::unexpected(std::string("15"));
  for (std::size_t area = 0; area < kOmronAreas.size(); ++area) {
    const OmronArea& row = kOmronAreas[area];
    if (row.letter != letter || *number < row.c_first || *number >= row.c_first + row.c_items)
      continue;
    const auto first = static_cast<std::uint32_t>(*number) - row.c_first;
    if (count > row.c_items - first || *bank >= (area == kOmronEm ? kOmronCModeBanks : 1))
      return tl::unexpected(std::string("15"));
    const Address address{area, static_cast<std::uint32_t>(*bank) * kEmBankWords + first};
    const std::uint8_t code = memory_.refusal(area, address.first, count, 0x15);
    if (code != 0) return tl::unexpected(hex(code, 2));
    return address;
  }
  return tl::unexpected(std::string("15"));
}

// first(4 decimal; EM with the bank before it) count(4 decimal)
Bytes HostLinkDevice::read(const Command& command, Instant now) {
  const char letter = command.header[1];
  const std::size_t digits = address_digits(letter);
  if (command.text.size() != digits + 4) return respond(command.header, "14");
  const std::string_view text = command.text;
  const auto requested = number_in(text.substr(digits), 10);
  if (!requested || (*requested == 0 && letter != 'D')) return respond(command.header, "15");
  const auto count = static_cast<std::uint32_t>(*requested == 0 ? 10000 : *requested);
  const auto address = address_of(letter, text.substr(0, digits), count);
  if (!address) return respond(command.header, address.error());
  const bool flags = letter == 'G';
  std::string data;
  for (std::uint32_t i = 0; i < count; ++i)
    data += hex(memory_.read(address->area, address->first + i, now), flags ? 1 : 4);
  std::size_t taken = std::min(data.size(), flags ? kFlagsFirst : kReadFirst);
  const std::string head = fmt::format("@{}{}00", decimal(unit_), command.header);
  const Bytes first = framed(head + data.substr(0, taken), taken == data.size());
  while (taken < data.size()) {
    const std::size_t size = std::min(data.size() - taken, flags ? kFlagsLater : kReadLater);
    later_frames_.push_back(framed(data.substr(taken, size), taken + size == data.size()));
    taken += size;
  }
  ++statistics_.responses;
  return first;
}

// first item, data; further frames have the rest of the data
Bytes HostLinkDevice::begin_write(const Command& command) {
  const std::size_t digits = address_digits(command.header[1]);
  if (command.text.size() <= digits) return respond(command.header, "14");
  writing_ = command.header;
  write_address_ = command.text.substr(0, digits);
  write_data_ = command.text.substr(digits);
  if (command.last) return finish_write();
  return {'\r'};
}

void HostLinkDevice::take_write_part(ByteView line, Reaction& reaction) {
  const bool last = !line.empty() && line.back() == '*';
  const std::size_t end = line.size() - (last ? 1 : 0);
  const auto abort = [&](std::string_view code) {
    reaction.response = respond(writing_, code);
    forget_transfer();
  };
  if (end < 3) return abort("A4");
  const ByteView text = line.first(end - 2);
  if (number_in(line.subspan(end - 2, 2)) != xor8(text)) {
    ++statistics_.bad_frames;
    return abort("A3");
  }
  if (text.size() > kWriteLater) return abort("A8");
  write_data_.append(text.begin(), text.end());
  reaction.response = last ? finish_write() : Bytes{'\r'};
}

Bytes HostLinkDevice::finish_write() {
  const std::string header = std::move(writing_);
  writing_.clear();
  const bool flags = header[1] == 'G';
  const std::size_t each = flags ? 1 : 4;
  if (write_data_.size() % each != 0) return respond(header, "14");
  const auto count = static_cast<std::uint32_t>(write_data_.size() / each);
  const auto address = address_of(header[1], write_address_, count);
  if (!address) return respond(header, address.error());
  std::vector<std::uint64_t> items;
  for (std::size_t at = 0; at < write_data_.size(); at += each) {
    const auto item = number_in(view(write_data_).subspan(at, each), flags ? 2 : 16);
    if (!item) return respond(header, "15");
    items.push_back(*item);
  }
  if (mode_ == 3) return respond(header, "01");
  for (std::uint32_t i = 0; i < count; ++i)
    memory_.write(address->area, address->first + i, items[i], statistics_);
  ++statistics_.write_requests;
  return respond(header, "00");
}

// response wait(1, tens of ms) message -> 00 message
Bytes HostLinkDevice::fins(const Command& command, Instant now, Duration& pause) {
  const auto wait =
      number_in(view(command.text).first(std::min<std::size_t>(1, command.text.size())));
  const auto message =
      command.text.empty() ? std::nullopt : bytes_in(view(command.text).subspan(1));
  if (!command.last || !wait || !message) return respond(command.header, "14");
  const Bytes response = fins_.execute(*message, now);
  if (response.empty()) return respond(command.header, "14");
  pause = std::chrono::milliseconds{10} * static_cast<int>(*wait);
  Bytes digits;
  for (const std::uint8_t byte : response) append_hex(digits, byte, 2);
  return respond(command.header, "00", std::string(digits.begin(), digits.end()));
}

tl::expected<std::unique_ptr<SimDevice>, std::string> make_hostlink_device(
    const DeviceSetup& setup) {
  return make_memory_device<HostLinkDevice>(setup, 31, parse_omron_address, "unit");
}

}  // namespace fieldcast::sim
