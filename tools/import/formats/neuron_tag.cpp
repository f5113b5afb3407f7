#include "tools/import/formats/neuron_tag.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "tools/import/points/address.hpp"
#include "tools/import/points/types.hpp"
#include "tools/import/text/text.hpp"

namespace fieldcast::importing {
namespace {

using MayFail = std::optional<std::string>;

struct TypeWord {
  std::string_view word;
  unsigned number;
  std::optional<ValueType> type;  // empty: not supported
};
constexpr TypeWord kTypes[] = {
    {"int8", 1, ValueType::kInt8},      {"uint8", 2, ValueType::kUint8},
    {"int16", 3, ValueType::kInt16},    {"uint16", 4, ValueType::kUint16},
    {"int32", 5, ValueType::kInt32},    {"uint32", 6, ValueType::kUint32},
    {"int64", 7, ValueType::kInt64},    {"uint64", 8, ValueType::kUint64},
    {"float", 9, ValueType::kFloat32},  {"double", 10, ValueType::kFloat64},
    {"bit", 11, ValueType::kBool},      {"bool", 12, ValueType::kBool},
    {"string", 13, ValueType::kString}, {"bytes", 14, std::nullopt},
    {"word", 16, ValueType::kUint16},   {"dword", 17, ValueType::kUint32},
    {"lword", 18, ValueType::kUint64}};

constexpr auto kBigWords = WordOrder::kBigEndian;
constexpr auto kLittleWords = WordOrder::kLittleEndian;
constexpr auto kBigBytes = ByteOrder::kBigEndian;
constexpr auto kLittleBytes = ByteOrder::kLittleEndian;

struct OrderWord {
  std::string_view suffix;  // of the address, after '#'
  unsigned of_32, of_64;    // equivalent setting of the node; 0: none
  Orders orders;
};
constexpr OrderWord kOrders[] = {
    {"LL", 1, 1, {kBigWords, kBigBytes}},      {"L", 1, 1, {kBigWords, kBigBytes}},
    {"LB", 2, 2, {kBigWords, kLittleBytes}},   {"BB", 3, 3, {kLittleWords, kLittleBytes}},
    {"B", 3, 3, {kLittleWords, kLittleBytes}}, {"BL", 4, 4, {kLittleWords, kBigBytes}}};

class TagReader {
 public:
  TagReader(const NeuronTag& tag, const NeuronOrders& orders) : tag_(tag), orders_(orders) {}

  tl::expected<ReadTag, std::string> read() {
    if (const auto fault = read_all()) return tl::unexpected(*fault);
    return std::move(result_);
  }

 private:
  MayFail read_all() {
    Point& point = result_.point;
    point.name = tag_.name;
    point.description = tag_.description;
    if (const auto fault = read_type()) return fault;
    if (const auto fault = read_address()) return fault;
    if (const auto fault = read_orders()) return fault;
    read_attribute();
    if (tag_.decimal && *tag_.decimal != 0) point.scale = *tag_.decimal;
    point.offset = tag_.bias.value_or(0);
    if (tag_.interval_ms && *tag_.interval_ms >= 1 && *tag_.interval_ms < 8e7)
      point.refresh = std::chrono::milliseconds{static_cast<std::int64_t>(*tag_.interval_ms)};
    return std::nullopt;
  }

  MayFail read_type() {
    const std::string word = lower(tag_.type);
    const auto number = whole_from(word);
    const auto found = std::ranges::find_if(kTypes, [&](const TypeWord& type) {
      return number ? type.number == *number : type.word == word;
    });
    if (found == std::end(kTypes) || !found->type)
      return fmt::format("the type {} has no counterpart", tag_.type);
    result_.point.type = *found->type;
    return std::nullopt;
  }

  // "1!400001", "1!400001.4", "1!400010.20H", "1!400001#BB"
  MayFail read_address() {
    std::string_view text = trimmed(tag_.address);
    const std::size_t mark = text.find('!');
    const auto slave = whole_from(text.substr(0, mark));
    if (mark == std::string_view::npos || !slave || *slave > 255)
      return fmt::format("'{}' is no address of Modbus (1!400001)", tag_.address);
    result_.slave = static_cast<std::uint16_t>(*slave);
    text.remove_prefix(mark + 1);
    if (const std::size_t hash = text.find('#'); hash != std::string_view::npos) {
      suffix_ = text.substr(hash + 1);
      text = text.substr(0, hash);
    }
    std::string_view part;
    if (const std::size_t point = text.find('.'); point != std::string_view::npos) {
      part = text.substr(point + 1);
      text = text.substr(0, point);
    }
    constexpr std::string_view kAreas = "0134";
    const std::size_t area = text.empty() ? std::string_view::npos : kAreas.find(text[0]);
    const auto number = area == std::string_view::npos ? std::nullopt : whole_from(text.substr(1));
    if (!number || *number < orders_.base || *number - orders_.base > 65535)
      return fmt::format("'{}' is no address of Modbus (1!400001)", tag_.address);
    return read_part(static_cast<ModbusArea>(area),
                     static_cast<std::uint32_t>(*number - orders_.base), part);
  }

  MayFail read_part(ModbusArea area, std::uint32_t first, std::string_view part) {
    Point& point = result_.point;
    area_ = area;
    std::optional<std::uint8_t> bit;
    if (point.type == ValueType::kString) {
      const bool low = part.ends_with('L');
      if (part.ends_with('D') || part.ends_with('E'))
        return "a text with one character in each register";
      if (low || part.ends_with('H')) part.remove_suffix(1);
      const auto bytes = whole_from(part);
      if (!bytes || *bytes == 0 || *bytes > kMaxStringBytes)
        return "a text without a length of 1 to 250 bytes";
      point.string_bytes = static_cast<std::uint16_t>(*bytes);
      if (low) point.byte_order = kLittleBytes;
    } else if (holds_bits(area)) {
      if (point.type != ValueType::kBool) return "a number at a single bit";
    } else if (point.type == ValueType::kBool) {
      const auto number = whole_from(part);
      if (!number || *number > 15) return "a bit of a register without its number";
      bit = static_cast<std::uint8_t>(*number);
    } else if (point.type == ValueType::kInt8 || point.type == ValueType::kUint8) {
      point.byte = 0;
    }
    point.at = address_text(area, first, bit);
    return std::nullopt;
  }

  MayFail read_orders() {
    Point& point = result_.point;
    if (!is_number(point.type) || point.byte) return std::nullopt;
    const unsigned registers = registers_of(point.type, 0);
    const auto found = std::ranges::find_if(kOrders, [&](const OrderWord& order) {
      if (!suffix_.empty()) return order.suffix == suffix_;
      if (registers == 1) return order.suffix == "L";
      return registers == 4 ? order.of_64 == orders_.of_64 : order.of_32 == orders_.of_32;
    });
    if (found == std::end(kOrders))
      return fmt::format("an order of bytes that no channel has (#{})", suffix_);
    point.word_order = registers == 1 ? kBigWords : found->orders.words;
    point.byte_order = found->orders.bytes;
    return std::nullopt;
  }

  // A sum of 1 (read), 2 (write) and more, or words.
  void read_attribute() {
    const auto number = whole_from(tag_.attribute);
    const std::string words = lower(tag_.attribute);
    const bool writes = number ? (*number & 2) != 0 : words.find("write") != std::string::npos;
    const bool reads = number ? (*number & 5) != 0
                              : words.find("read") != std::string::npos ||
                                    words.find("subscribe") != std::string::npos;
    if (writes && can_be_written(area_))
      result_.point.access = reads ? Access::kReadWrite : Access::kWriteOnly;
  }

  const NeuronTag& tag_;
  const NeuronOrders& orders_;
  ReadTag result_;
  std::string_view suffix_;
  ModbusArea area_ = ModbusArea::kHolding;
};

}  // namespace

tl::expected<ReadTag, std::string> read_neuron_tag(const NeuronTag& tag,
                                                   const NeuronOrders& orders) {
  return TagReader(tag, orders).read();
}

}  // namespace fieldcast::importing
