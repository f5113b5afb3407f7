#include "tools/sim/families/fins_unit.hpp"

#include <algorithm>
#include <string_view>

#include "tools/sim/device/device.hpp"

namespace fieldcast::sim {

namespace {

constexpr std::array<std::string_view, 11> kOtherNames{"IR", "WR",  "L",   "H",    "A",   "D",
                                                       "E",  "TIM", "CNT", "TIMF", "CNTF"};

}  // namespace

std::vector<ItemArea> omron_areas() {
  std::vector<ItemArea> areas;
  for (std::size_t i = 0; i < kOmronAreas.size(); ++i) {
    const std::uint32_t banks = i == kOmronEm ? kOmronEmBanks : 1;
    areas.push_back({kOmronAreaNames[i], kOmronAreas[i].bits,
                     std::max(kOmronAreas[i].items, kOmronAreas[i].c_items) * banks});
  }
  return areas;
}

std::optional<ItemAddress> parse_omron_address(std::string_view at) {
  const std::size_t underscore = at.find('_');
  // The EM bank may be a letter: E1_100, EMC_0.
  const std::size_t digits = underscore != std::string_view::npos && underscore > 0
                                 ? underscore - 1
                                 : std::min(at.find_first_of("0123456789"), at.size());
  const std::string_view name = at.substr(0, digits);
  for (std::size_t area = 0; area < kOmronAreas.size(); ++area) {
    if (name != kOmronAreaNames[area] && name != kOtherNames[area]) continue;
    if ((area == kOmronEm) != (underscore != std::string_view::npos)) return std::nullopt;
    ItemAddress address{.area = area};
    std::string_view rest = at.substr(digits);
    if (area == kOmronEm) {
      const auto bank = address_number(rest.substr(0, 1), 16);
      if (!bank || *bank >= kOmronEmBanks) return std::nullopt;
      address.first = static_cast<std::uint32_t>(*bank) * kEmBankWords;
      rest = rest.substr(2);
    }
    const std::size_t dot = rest.find('.');
    const auto item = address_number(rest.substr(0, dot));
    if (!item || *item >= kEmBankWords) return std::nullopt;
    address.first += static_cast<std::uint32_t>(*item);
    if (dot == std::string_view::npos) return address;
    const auto bit = address_number(rest.substr(dot + 1));
    if (!bit || *bit >= kOmronAreas[area].bits || kOmronAreas[area].bits == 1) return std::nullopt;
    address.bit = static_cast<std::uint8_t>(*bit);
    return address;
  }
  return std::nullopt;
}

namespace {

constexpr std::size_t kAddressSize = 4;
constexpr std::uint16_t kUndefined = 0x0401, kCommandTooLong = 0x1001, kCommandTooShort = 0x1002,
                        kCountDiffers = 0x1003, kNoArea = 0x1101, kStartOutside = 0x1103,
                        kEndOutside = 0x1104, kResponseTooLong = 0x110B, kParameter = 0x110C;
constexpr std::string_view kCpuModel = "CS1H-CPU67H", kCpuVersion = "04.00";
constexpr std::size_t kCpuText = 20, kCpuSystem = 40, kCpuAreas = 12, kBusUnits = 65;

}  // namespace

Bytes FinsUnit::execute(ByteView message, Instant now) {
  const bool relayed = !message.empty() && (message[0] & 0x80u) != 0;
  const std::size_t head = relayed ? 10 : 4;
  if (message.size() < head + 2 || (message[0] & 0x40u) != 0) return {};
  const std::uint16_t command = read_u16(message, head);
  Bytes response(message.begin(), message.begin() + static_cast<std::ptrdiff_t>(head));
  response[0] = relayed ? 0xC0 : 0x40;
  if (relayed) {
    response[2] = 0x02;
    std::swap_ranges(response.begin() + 3, response.begin() + 6, response.begin() + 6);
  }
  append_u16(response, command);
  ++statistics_.requests["FA " + to_hex(message.subspan(head, 2), '\0')];
  Result result = dispatch(command, message.subspan(head + 2), now);
  if (response.size() + 2 + result.data.size() > limits_.response) result = {kResponseTooLong, {}};
  if (result.end != 0) ++statistics_.exceptions[result.end];
  append_u16(response, result.end);
  append(response, result.data);
  return response;
}

FinsUnit::Result FinsUnit::dispatch(std::uint16_t command, ByteView text, Instant now) {
  switch (command) {
    case 0x0101: return read(text, now);
    case 0x0102: return write(text, now);
    case 0x0103: return fill(text, now);
    case 0x0104: return read_many(text, now);
    case 0x0105: return transfer(text, now);
    case 0x0401: mode_ = text.size() >= 3 ? text[2] : std::uint8_t{2}; return {};
    case 0x0402: mode_ = 0; return {};
    case 0x0501: return cpu_data(text);
    case 0x0601: {  // status, mode, errors, and a message of 16 characters
      Bytes data{static_cast<std::uint8_t>(mode_ == 0 ? 0x04 : 0x05), mode_};
      data.resize(10);
      data.insert(data.end(), 16, ' ');
      return {0, std::move(data)};
    }
    default: return {kUndefined, {}};
  }
}

std::optional<FinsUnit::Address> FinsUnit::address_of(ByteView bytes) {
  const std::uint8_t code = bytes[0];
  const std::uint32_t number = read_u16(bytes, 1);
  for (std::size_t area = 0; area < kOmronAreas.size(); ++area) {
    const OmronArea& row = kOmronAreas[area];
    const unsigned banks = area == kOmronEm ? kOmronEmBanks : 1;
    const bool words = row.word_code != 0 && code >= row.word_code && code < row.word_code + banks;
    const bool bits = row.bit_code != 0 && code >= row.bit_code && code < row.bit_code + banks;
    // Timers and counters share a code; the number distinguishes them.
    const bool counters = number >= 0x8000;
    const bool shared = code == 0x89 || code == 0x09;
    if ((!words && !bits) || (shared && counters != (row.fins_first != 0))) continue;
    const unsigned bank = words ? code - row.word_code : code - row.bit_code;
    Address address{area, bank * row.items + number - row.fins_first, {}};
    if (bits && row.bits != 1) address.bit = bytes[3];
    return address;
  }
  return std::nullopt;
}

std::size_t FinsUnit::item_size(const Address& address) {
  return address.bit || kOmronAreas[address.area].bits == 1 ? 1 : 2;
}

std::uint16_t FinsUnit::refusal(const Address& address, std::uint32_t count) const {
  const OmronArea& row = kOmronAreas[address.area];
  if (address.bit && *address.bit > 15) return kStartOutside;
  const std::uint32_t words = address.bit ? (*address.bit + count + 15) / 16 : count;
  const std::uint32_t within = address.first % row.items;
  if (address.area != kOmronEm && address.first >= row.items) return kStartOutside;
  if (words > row.items - within) return kEndOutside;
  const std::uint8_t code = memory_.refusal(address.area, address.first, words, 0x03);
  return code == 0 ? 0 : static_cast<std::uint16_t>(0x1100 | code);
}

void FinsUnit::append_items(const Address& address, std::uint32_t count, Instant now,
                            Bytes& out) const {
  for (std::uint32_t i = 0; i < count; ++i) {
    const std::uint32_t bit = address.bit.value_or(0) + i;
    const std::uint64_t item =
        memory_.read(address.area, address.first + (address.bit ? bit / 16 : i), now);
    if (address.bit)
      out.push_back(static_cast<std::uint8_t>(item >> bit % 16 & 1u));
    else if (item_size(address) == 1)
      out.push_back(item != 0 ? 1 : 0);
    else
      append_u16(out, static_cast<std::uint16_t>(item));
  }
}

void FinsUnit::store(const Address& address, std::uint32_t count, ByteView data, Instant now) {
  for (std::uint32_t i = 0; i < count; ++i) {
    const std::uint32_t bit = address.bit.value_or(0) + i;
    const std::uint32_t item = address.first + (address.bit ? bit / 16 : i);
    if (address.bit) {
      const std::uint64_t mask = std::uint64_t{1} << bit % 16,
                          old = memory_.read(address.area, item, now);
      memory_.write(address.area, item, data[i] != 0 ? old | mask : old & ~mask, statistics_);
    } else {
      memory_.write(address.area, item, item_size(address) == 1 ? data[i] : read_u16(data, 2 * i),
                    statistics_);
    }
  }
  ++statistics_.write_requests;
}

// area(1) address(2) bit(1) count(2) -> items
FinsUnit::Result FinsUnit::read(ByteView text, Instant now) const {
  if (text.size() != kAddressSize + 2)
    return {text.size() < kAddressSize + 2 ? kCommandTooShort : kCommandTooLong, {}};
  const auto address = address_of(text);
  const std::uint32_t count = read_u16(text, kAddressSize);
  if (!address) return {kNoArea, {}};
  if (count == 0) return {kParameter, {}};
  if (const std::uint16_t code = refusal(*address, count); code != 0) return {code, {}};
  Result result;
  append_items(*address, count, now, result.data);
  return result;
}

// area(1) address(2) bit(1) count(2) items
FinsUnit::Result FinsUnit::write(ByteView text, Instant now) {
  if (text.size() < kAddressSize + 2) return {kCommandTooShort, {}};
  const auto address = address_of(text);
  const std::uint32_t count = read_u16(text, kAddressSize);
  if (!address) return {kNoArea, {}};
  if (count == 0) return {kParameter, {}};
  const ByteView data = text.subspan(kAddressSize + 2);
  if (data.size() != count * item_size(*address)) return {kCountDiffers, {}};
  // flags can be forced, not written
  if (kOmronAreas[address->area].bits == 1) return {kNoArea, {}};
  if (const std::uint16_t code = refusal(*address, count); code != 0) return {code, {}};
  store(*address, count, data, now);
  return {};
}

// area(1) address(2) bit(1) count(2) word(2)
FinsUnit::Result FinsUnit::fill(ByteView text, Instant now) {
  if (text.size() != kAddressSize + 4)
    return {text.size() < kAddressSize + 4 ? kCommandTooShort : kCommandTooLong, {}};
  const auto address = address_of(text);
  const std::uint32_t count = read_u16(text, kAddressSize);
  if (!address || item_size(*address) != 2) return {kNoArea, {}};
  if (const std::uint16_t code = refusal(*address, count); code != 0) return {code, {}};
  Bytes data;
  for (std::uint32_t i = 0; i < count; ++i) append(data, text.subspan(kAddressSize + 2, 2));
  store(*address, count, data, now);
  return {};
}

// (area(1) address(2) bit(1)).. -> area and item, for each
FinsUnit::Result FinsUnit::read_many(ByteView text, Instant now) const {
  if (text.empty() || text.size() % kAddressSize != 0) return {kCountDiffers, {}};
  if (text.size() / kAddressSize > limits_.items) return {kCommandTooLong, {}};
  Result result;
  for (std::size_t at = 0; at < text.size(); at += kAddressSize) {
    const auto address = address_of(text.subspan(at));
    if (!address) return {kNoArea, {}};
    if (const std::uint16_t code = refusal(*address, 1); code != 0) return {code, {}};
    result.data.push_back(text[at]);
    append_items(*address, 1, now, result.data);
  }
  return result;
}

// area(1) address(2) bit(1) area(1) address(2) bit(1) count(2)
FinsUnit::Result FinsUnit::transfer(ByteView text, Instant now) {
  if (text.size() != 2 * kAddressSize + 2)
    return {text.size() < 2 * kAddressSize + 2 ? kCommandTooShort : kCommandTooLong, {}};
  const auto from = address_of(text), to = address_of(text.subspan(kAddressSize));
  const std::uint32_t count = read_u16(text, 2 * kAddressSize);
  if (!from || !to || item_size(*from) != 2 || item_size(*to) != 2) return {kNoArea, {}};
  for (const Address& address : {*from, *to}) {
    if (const std::uint16_t code = refusal(address, count); code != 0) return {code, {}};
  }
  Bytes data;
  append_items(*from, count, now, data);
  store(*to, count, data, now);
  return {};
}

// [00: the CPU, 01: units on its bus] -> model(20) version(20) for the system(40) areas(12); 01: 64
// bytes of units and one of remote I/O; no parameter: both (W342, 5-3-15).
FinsUnit::Result FinsUnit::cpu_data(ByteView text) {
  if (text.size() > 1) return {kCommandTooLong, {}};
  if (!text.empty() && text[0] > 1) return {kParameter, {}};
  Result result;
  if (text.empty() || text[0] == 0) {
    Bytes& data = result.data;
    data.assign(kCpuModel.begin(), kCpuModel.end());
    data.resize(kCpuText, ' ');
    data.insert(data.end(), kCpuVersion.begin(), kCpuVersion.end());
    data.resize(2 * kCpuText + kCpuSystem + kCpuAreas);
  }
  if (text.empty() || text[0] == 1) result.data.resize(result.data.size() + kBusUnits);
  return result;
}

}  // namespace fieldcast::sim
