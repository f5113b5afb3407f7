#include "tools/sim/families/s7_unit.hpp"

#include <algorithm>

#include "tools/sim/device/device.hpp"

namespace fieldcast::sim {

std::vector<ItemArea> s7_areas(std::span<const S7Area> areas) {
  std::vector<ItemArea> items;
  for (const S7Area& area : areas) items.push_back({area.name, area.bits, area.items});
  return items;
}

namespace {

// "DB10." before an address in a data block.
struct BlockAddress {
  std::uint32_t block = 0;  // 0: none
  std::string_view rest;
};
std::optional<BlockAddress> block_of(std::string_view at) {
  const std::size_t dot = at.find('.');
  if (!at.starts_with("DB") || dot == std::string_view::npos) return BlockAddress{0, at};
  const auto number = address_number(at.substr(2, dot - 2));
  if (!number || *number < 1 || *number > 65535) return std::nullopt;
  return BlockAddress{static_cast<std::uint32_t>(*number), at.substr(dot + 1)};
}

// Letters between the name of the area and the number: of a byte, a word, two words, four words.
bool is_width(const S7Area& area, std::string_view letters) {
  if (area.counted) return letters.empty();
  if (area.bits == 16) return letters == "W";
  return letters == "B" || letters == "W" || letters == "D" || letters == "L" ||
         (area.blocks && letters == "S");
}

}  // namespace

std::optional<ItemAddress> parse_s7_address(std::span<const S7Area> areas, std::string_view at) {
  const auto place = block_of(at);
  if (!place) return std::nullopt;
  const std::string_view text = place->rest;
  const std::size_t digits = std::min(text.find_first_of("0123456789"), text.size());
  const std::size_t dot = std::min(text.find('.'), text.size());
  std::string_view letters = text.substr(0, digits);
  if (dot < digits) return std::nullopt;
  if (place->block != 0 && (letters == "DTL" || letters == "DT")) letters = "DBS";
  const auto number = address_number(text.substr(digits, dot - digits));
  if (!number || *number > 0xFFFFFF) return std::nullopt;
  for (std::size_t index = 0; index < areas.size(); ++index) {
    const S7Area& area = areas[index];
    if (!letters.starts_with(area.name) || area.blocks != (place->block != 0)) continue;
    const std::string_view width = letters.substr(area.name.size());
    ItemAddress address{.area = index, .first = static_cast<std::uint32_t>(*number)};
    if (area.bits == 16 && !area.counted) {
      if (*number % 2 != 0) continue;
      address.first /= 2;
    }
    if (area.blocks) {
      if (address.first >= kS7BlockBytes) continue;
      address.first += (place->block - 1) * kS7BlockBytes;
    }
    if (dot == text.size()) {
      if (is_width(area, width)) return address;
      continue;
    }
    const auto bit = address_number(text.substr(dot + 1));
    if (area.bits != 8 || width != (area.blocks ? "X" : "") || !bit || *bit > 7) continue;
    address.bit = static_cast<std::uint8_t>(*bit);
    return address;
  }
  return std::nullopt;
}

namespace {

constexpr std::size_t kHead = 10, kItem = 12;
constexpr std::uint8_t kGood = 0xFF, kNotAccessible = 0x03, kOutOfRange = 0x05, kTypeWrong = 0x06,
                       kSizeWrong = 0x07, kMissing = 0x0A;
constexpr std::uint16_t kNoList = 0xD401, kConnections = 16;
constexpr std::string_view kCpuName = "CPU 1511-1 PN", kOrderNumber = "6ES7 511-1AK02-0AB0 ";
constexpr std::uint16_t kUnknownFunction = 0x8104, kTooLong = 0x8500;

Bytes acknowledge(ByteView reference, std::uint16_t error, ByteView parameters, ByteView data) {
  const std::uint8_t kind = error == 0 ? 0x03 : 0x02;  // with data, without data
  Bytes response{0x32, kind, 0x00, 0x00};
  append(response, reference);
  append_u16(response, static_cast<std::uint16_t>(parameters.size()));
  append_u16(response, static_cast<std::uint16_t>(data.size()));
  append_u16(response, error);
  append(response, parameters);
  append(response, data);
  return response;
}

}  // namespace

std::uint8_t S7Unit::counted(std::uint8_t fault) {
  if (fault != kGood) ++statistics_.exceptions[fault];
  return fault;
}

Bytes S7Unit::refuse(ByteView reference, std::uint16_t error) {
  ++statistics_.exceptions[error];
  return acknowledge(reference, error, {}, {});
}

// 32 07 .. 000112 04 11 44 01 00, FF 09 0004 list(2) index(2): reads a system status list. The CPU
// has the lists 001C and 0011 (names) and 0131 (connections).
Bytes S7Unit::status_list(ByteView request) {
  constexpr std::size_t kRequest = 26, kListAt = 22;
  if (request.size() != kRequest || request[14] != 0x11 || request[15] != 0x44) return {};
  ++statistics_.responses;
  const std::uint16_t list = read_u16(request, kListAt);
  ++statistics_.requests["list"];
  Bytes records;
  const auto add = [&](std::uint16_t index, std::string_view text, std::size_t size) {
    append_u16(records, index);
    records.insert(records.end(), text.begin(), text.end());
    records.resize(records.size() + size - text.size());
  };
  std::uint16_t size = 0;
  if (list == 0x001C) {
    for (const std::uint16_t index : std::array<std::uint16_t, 6>{1, 2, 3, 4, 5, 7})
      add(index, index == 7 ? kCpuName : "", 32);
    size = 34;
  } else if (list == 0x0011) {
    add(1, kOrderNumber, 26);
    add(7, "", 22);
    append(records, Bytes{'V', 2, 9, 4});
    size = 28;
  } else if (list == 0x0131) {
    append_u16(records, 1);
    append_u16(records, most_);
    append_u16(records, kConnections);
    records.resize(40);
    size = 40;
  }
  const bool known = size != 0;
  Bytes response{0x32, 0x07, 0, 0, request[4], request[5], 0, 12, 0};
  response.push_back(static_cast<std::uint8_t>(known ? 12 + records.size() : 4));
  append(response, Bytes{0, 1, 0x12, 8, 0x12, 0x84, 1, 1, 0, 0});
  append_u16(response, known ? 0 : kNoList);
  append(response, Bytes{known ? kGood : kMissing, 9});
  append_u16(response, static_cast<std::uint16_t>(known ? 8 + records.size() : 0));
  if (!known) return response;
  append(response, request.subspan(kListAt, 4));
  append_u16(response, size);
  append_u16(response, static_cast<std::uint16_t>(records.size() / size));
  append(response, records);
  return response;
}

Bytes S7Unit::execute(ByteView job, Instant now) {
  if (job.size() > 1 && job[0] == 0x32 && job[1] == 0x07) return status_list(job);
  if (job.size() < kHead + 1 || job[0] != 0x32 || job[1] != 0x01) return {};
  const ByteView reference = job.subspan(4, 2);
  const std::size_t parameter_size = read_u16(job, 6), data_size = read_u16(job, 8);
  if (parameter_size == 0 || kHead + parameter_size + data_size != job.size()) return {};
  const ByteView parameters = job.subspan(kHead, parameter_size),
                 data = job.subspan(kHead + parameter_size);
  ++statistics_.responses;
  const std::uint8_t function = parameters[0];
  const bool items = function == 0x04 || function == 0x05;
  if (items && (parameter_size < 2 || parameter_size != 2 + kItem * parameters[1])) {
    --statistics_.responses;
    return {};
  }
  switch (function) {
    case 0x04: return read(reference, parameters.subspan(2), now);
    case 0x05: return write(reference, parameters.subspan(2), data, now);
    case 0x28:
    case 0x29:  // start and stop have no effect on the simulated plant
      ++statistics_.requests[function == 0x28 ? "start" : "stop"];
      return acknowledge(reference, 0, parameters.first(1), {});
    case 0xF0: {
      ++statistics_.requests["negotiate"];
      if (parameter_size != 8) return refuse(reference, kUnknownFunction);
      Bytes granted{0xF0, 0x00, 0x00, 0x01, 0x00, 0x01};
      append_u16(granted, std::min(read_u16(parameters, 6), most_));
      return acknowledge(reference, 0, granted, {});
    }
    default: ++statistics_.requests["other"]; return refuse(reference, kUnknownFunction);
  }
}

// 12 0A 10 TS count(2) DB(2) area address(3)
S7Unit::Item S7Unit::item_of(ByteView bytes) const {
  Item item{.count = read_u16(bytes, 4)};
  if (bytes[0] != 0x12 || bytes[1] != 0x0A || bytes[2] != 0x10) return {.fault = kTypeWrong};
  const std::uint8_t transport = bytes[3];
  const auto area = std::ranges::find(areas_, bytes[8], &S7Area::code);
  if (area == areas_.end()) return {.fault = kMissing};
  item.area = static_cast<std::size_t>(area - areas_.begin());
  const std::uint32_t address = read_u32(bytes, 8) & 0xFFFFFFu;
  if (area->counted) {
    item.first = address;
    item.fault = transport == area->code ? 0 : kNotAccessible;
    return item;
  }
  item.first = address / area->bits;
  const std::uint32_t within = address % area->bits;
  if (transport == 0x01) {
    item.bit = static_cast<std::uint8_t>(within);
    item.fault = area->bits != 8 ? kNotAccessible : item.count != 1 ? kTypeWrong : 0;
    return area->blocks ? in_block(item, read_u16(bytes, 6)) : item;
  }
  const std::uint32_t bytes_each = transport == 0x02   ? 1
                                   : transport == 0x04 ? 2
                                   : transport == 0x06 ? 4
                                                       : 0;
  if (bytes_each == 0) item.fault = kTypeWrong;
  if (area->bits == 16 && bytes_each != 2) item.fault = kNotAccessible;
  if (within != 0) item.fault = kOutOfRange;
  item.count = item.count * bytes_each * 8 / area->bits;
  return area->blocks ? in_block(item, read_u16(bytes, 6)) : item;
}

S7Unit::Item S7Unit::in_block(Item item, std::uint32_t block) {
  if (block == 0) return {.fault = kMissing};
  if (item.first >= kS7BlockBytes || item.count > kS7BlockBytes - item.first)
    item.fault = kOutOfRange;
  item.first += (block - 1) * kS7BlockBytes;
  return item;
}

std::uint8_t S7Unit::fault_of(const Item& item) const {
  if (item.fault != 0) return item.fault;
  if (item.count == 0) return kTypeWrong;
  return memory_.refusal(item.area, item.first, item.count, kOutOfRange);
}

Bytes S7Unit::value_of(const Item& item, Instant now) const {
  Bytes value;
  for (std::uint32_t i = item.first; i < item.first + item.count; ++i) {
    const std::uint64_t bits = memory_.read(item.area, i, now);
    if (item.bit) return {static_cast<std::uint8_t>(bits >> *item.bit & 1u)};
    value.resize(value.size() + areas_[item.area].status);
    for (unsigned left = areas_[item.area].bits / 8; left-- > 0;)
      value.push_back(static_cast<std::uint8_t>(bits >> 8 * left));
  }
  return value;
}

Bytes S7Unit::read(ByteView reference, ByteView items, Instant now) {
  ++statistics_.requests["read"];
  Bytes data;
  for (std::size_t at = 0; at < items.size(); at += kItem) {
    const Item item = item_of(items.subspan(at, kItem));
    // all but the last value are padded to an even length
    if (data.size() % 2 != 0) data.push_back(0);
    if (const std::uint8_t fault = fault_of(item); fault != 0) {
      append(data, Bytes{counted(fault), 0, 0, 0});
      continue;
    }
    const Bytes value = value_of(item, now);
    const bool octets = areas_[item.area].counted;
    append(data, Bytes{kGood, static_cast<std::uint8_t>(item.bit ? 0x03 : octets ? 0x09 : 0x04)});
    append_u16(data,
               static_cast<std::uint16_t>(item.bit || octets ? value.size() : 8 * value.size()));
    append(data, value);
    if (data.size() > most_) return refuse(reference, kTooLong);
  }
  const Bytes parameters{0x04, static_cast<std::uint8_t>(items.size() / kItem)};
  if (12 + parameters.size() + data.size() > most_) return refuse(reference, kTooLong);
  return acknowledge(reference, 0, parameters, data);
}

// Data for each item: 00 TS length(2) value, padded to an even length.
Bytes S7Unit::write(ByteView reference, ByteView items, ByteView data, Instant now) {
  ++statistics_.requests["write"];
  Bytes codes;
  for (std::size_t at = 0; at < items.size(); at += kItem) {
    const Item item = item_of(items.subspan(at, kItem));
    const std::uint8_t transport = data.size() >= 4 ? data[1] : 0;
    const std::uint16_t length = data.size() >= 4 ? read_u16(data, 2) : 0;
    const std::size_t size = transport == 0x04 ? length / 8u : length;
    if (data.size() < 4 || data.size() - 4 < size) {
      codes.push_back(counted(kSizeWrong));
      data = {};
      continue;
    }
    codes.push_back(counted(store(item, transport, length, data.subspan(4, size), now)));
    data = data.subspan(std::min(data.size(), 4 + size + size % 2));
  }
  const Bytes parameters{0x05, static_cast<std::uint8_t>(items.size() / kItem)};
  return acknowledge(reference, 0, parameters, codes);
}

std::uint8_t S7Unit::store(const Item& item, std::uint8_t transport, std::uint16_t length,
                           ByteView value, Instant now) {
  if (const std::uint8_t fault = fault_of(item); fault != 0) return fault;
  const S7Area& area = areas_[item.area];
  if (item.first < area.locked) return kNotAccessible;
  if (item.bit) {
    if (transport != 0x03 || length != 1) return kSizeWrong;
    const std::uint64_t old =
        memory_.read(item.area, item.first, now) & ~(std::uint64_t{1} << *item.bit);
    memory_.write(item.area, item.first, old | std::uint64_t{value[0] & 1u} << *item.bit,
                  statistics_);
  } else {
    const std::size_t width = area.bits / 8;
    if (transport != 0x04 || value.size() != item.count * width) return kSizeWrong;
    for (std::uint32_t i = 0; i < item.count; ++i) {
      std::uint64_t bits = 0;
      for (std::size_t byte = 0; byte < width; ++byte) bits = bits << 8 | value[i * width + byte];
      memory_.write(item.area, item.first + i, bits, statistics_);
    }
  }
  ++statistics_.write_requests;
  return kGood;
}

}  // namespace fieldcast::sim
