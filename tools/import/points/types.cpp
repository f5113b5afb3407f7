#include "tools/import/points/types.hpp"

#include <algorithm>
#include <array>

#include "tools/import/text/text.hpp"

namespace fieldcast::importing {
namespace {

struct Name {
  std::string_view name;  // letters and digits only, lower case
  ValueType type;
};

constexpr Name kNames[] = {{"bool", ValueType::kBool},
                           {"boolean", ValueType::kBool},
                           {"bit", ValueType::kBool},
                           {"coil", ValueType::kBool},
                           {"binary", ValueType::kBool},
                           {"digital", ValueType::kBool},
                           {"onoff", ValueType::kBool},
                           {"discrete", ValueType::kBool},
                           {"int8", ValueType::kInt8},
                           {"s8", ValueType::kInt8},
                           {"i8", ValueType::kInt8},
                           {"sint8", ValueType::kInt8},
                           {"sint", ValueType::kInt8},
                           {"char", ValueType::kInt8},
                           {"uint8", ValueType::kUint8},
                           {"u8", ValueType::kUint8},
                           {"usint", ValueType::kUint8},
                           {"byte", ValueType::kUint8},
                           {"uchar", ValueType::kUint8},
                           {"int16", ValueType::kInt16},
                           {"s16", ValueType::kInt16},
                           {"i16", ValueType::kInt16},
                           {"sint16", ValueType::kInt16},
                           {"short", ValueType::kInt16},
                           {"signedshort", ValueType::kInt16},
                           {"int", ValueType::kInt16},
                           {"integer", ValueType::kInt16},
                           {"signed", ValueType::kInt16},
                           {"signed16", ValueType::kInt16},
                           {"16bitsigned", ValueType::kInt16},
                           {"16bitint", ValueType::kInt16},
                           {"signedint16", ValueType::kInt16},
                           {"16bitsignedinteger", ValueType::kInt16},
                           {"signed16bit", ValueType::kInt16},
                           {"16bitinteger", ValueType::kInt16},
                           {"signedint", ValueType::kInt16},
                           {"signed16bitinteger", ValueType::kInt16},
                           {"uint16", ValueType::kUint16},
                           {"u16", ValueType::kUint16},
                           {"ushort", ValueType::kUint16},
                           {"unsignedshort", ValueType::kUint16},
                           {"word", ValueType::kUint16},
                           {"uint", ValueType::kUint16},
                           {"unsigned", ValueType::kUint16},
                           {"unsigned16", ValueType::kUint16},
                           {"16bitunsigned", ValueType::kUint16},
                           {"16bituint", ValueType::kUint16},
                           {"16bitunsignedinteger", ValueType::kUint16},
                           {"unsigned16bit", ValueType::kUint16},
                           {"unsignedint16", ValueType::kUint16},
                           {"unsignedint", ValueType::kUint16},
                           {"unsigned16bitinteger", ValueType::kUint16},
                           {"unsignedinteger", ValueType::kUint16},
                           {"enum", ValueType::kUint16},
                           {"enum16", ValueType::kUint16},
                           {"bitfield16", ValueType::kUint16},
                           {"bitmap", ValueType::kUint16},
                           {"bitmap16", ValueType::kUint16},
                           {"acc16", ValueType::kUint16},
                           {"register", ValueType::kUint16},
                           {"int16u", ValueType::kUint16},
                           {"int32u", ValueType::kUint32},
                           {"int64u", ValueType::kUint64},
                           {"int32", ValueType::kInt32},
                           {"s32", ValueType::kInt32},
                           {"i32", ValueType::kInt32},
                           {"sint32", ValueType::kInt32},
                           {"dint", ValueType::kInt32},
                           {"long", ValueType::kInt32},
                           {"longint", ValueType::kInt32},
                           {"signed32", ValueType::kInt32},
                           {"32bitsigned", ValueType::kInt32},
                           {"32bitint", ValueType::kInt32},
                           {"signedint32", ValueType::kInt32},
                           {"32bitsignedinteger", ValueType::kInt32},
                           {"signed32bit", ValueType::kInt32},
                           {"32bitinteger", ValueType::kInt32},
                           {"signedlong", ValueType::kInt32},
                           {"signed32bitinteger", ValueType::kInt32},
                           {"uint32", ValueType::kUint32},
                           {"u32", ValueType::kUint32},
                           {"dword", ValueType::kUint32},
                           {"udint", ValueType::kUint32},
                           {"ulong", ValueType::kUint32},
                           {"unsigned32", ValueType::kUint32},
                           {"32bitunsigned", ValueType::kUint32},
                           {"32bituint", ValueType::kUint32},
                           {"unsignedlong", ValueType::kUint32},
                           {"32bitunsignedinteger", ValueType::kUint32},
                           {"unsigned32bit", ValueType::kUint32},
                           {"unsignedint32", ValueType::kUint32},
                           {"unsigned32bitinteger", ValueType::kUint32},
                           {"acc32", ValueType::kUint32},
                           {"bitfield32", ValueType::kUint32},
                           {"enum32", ValueType::kUint32},
                           {"int64", ValueType::kInt64},
                           {"s64", ValueType::kInt64},
                           {"i64", ValueType::kInt64},
                           {"sint64", ValueType::kInt64},
                           {"lint", ValueType::kInt64},
                           {"llong", ValueType::kInt64},
                           {"longlong", ValueType::kInt64},
                           {"signed64", ValueType::kInt64},
                           {"64bitsigned", ValueType::kInt64},
                           {"64bitint", ValueType::kInt64},
                           {"signed64bit", ValueType::kInt64},
                           {"64bitsignedinteger", ValueType::kInt64},
                           {"uint64", ValueType::kUint64},
                           {"u64", ValueType::kUint64},
                           {"qword", ValueType::kUint64},
                           {"lword", ValueType::kUint64},
                           {"ulint", ValueType::kUint64},
                           {"unsigned64", ValueType::kUint64},
                           {"64bitunsigned", ValueType::kUint64},
                           {"64bituint", ValueType::kUint64},
                           {"unsigned64bit", ValueType::kUint64},
                           {"64bitunsignedinteger", ValueType::kUint64},
                           {"acc64", ValueType::kUint64},
                           {"float", ValueType::kFloat32},
                           {"float32", ValueType::kFloat32},
                           {"f32", ValueType::kFloat32},
                           {"real", ValueType::kFloat32},
                           {"real32", ValueType::kFloat32},
                           {"single", ValueType::kFloat32},
                           {"flt32", ValueType::kFloat32},
                           {"32bitfloat", ValueType::kFloat32},
                           {"float32bit", ValueType::kFloat32},
                           {"ieee754", ValueType::kFloat32},
                           {"floatingpoint", ValueType::kFloat32},
                           {"32bitreal", ValueType::kFloat32},
                           {"floatieee754", ValueType::kFloat32},
                           {"32bitfloatingpoint", ValueType::kFloat32},
                           {"float32ieee", ValueType::kFloat32},
                           {"ieee754float", ValueType::kFloat32},
                           {"ieeefloat", ValueType::kFloat32},
                           {"double", ValueType::kFloat64},
                           {"float64", ValueType::kFloat64},
                           {"f64", ValueType::kFloat64},
                           {"lreal", ValueType::kFloat64},
                           {"real64", ValueType::kFloat64},
                           {"64bitfloat", ValueType::kFloat64},
                           {"64bitreal", ValueType::kFloat64},
                           {"float64ieee", ValueType::kFloat64},
                           {"64bitfloatingpoint", ValueType::kFloat64},
                           {"bcd8", ValueType::kBcd8},
                           {"bcd", ValueType::kBcd16},
                           {"bcd16", ValueType::kBcd16},
                           {"16bitbcd", ValueType::kBcd16},
                           {"lbcd", ValueType::kBcd32},
                           {"bcd32", ValueType::kBcd32},
                           {"32bitbcd", ValueType::kBcd32},
                           {"string", ValueType::kString},
                           {"text", ValueType::kString},
                           {"ascii", ValueType::kString},
                           {"str", ValueType::kString},
                           {"utf8", ValueType::kString}};

bool cut(std::string& text, std::string_view word) {
  if (!text.ends_with(word) || text.size() == word.size()) return false;
  text.resize(text.size() - word.size());
  return true;
}

struct OrderWord {
  std::string_view word;
  std::optional<WordOrder> words;
  std::optional<ByteOrder> bytes;
};
constexpr auto kLittleWords = WordOrder::kLittleEndian;
constexpr auto kBigWords = WordOrder::kBigEndian;
constexpr OrderWord kOrderWords[] = {
    {"lebs", kLittleWords, ByteOrder::kLittleEndian},
    {"bebs", kBigWords, ByteOrder::kLittleEndian},
    {"le", kLittleWords, ByteOrder::kBigEndian},
    {"be", kBigWords, ByteOrder::kBigEndian},
    {"abcd", kBigWords, ByteOrder::kBigEndian},
    {"cdab", kLittleWords, ByteOrder::kBigEndian},
    {"badc", kBigWords, ByteOrder::kLittleEndian},
    {"dcba", kLittleWords, ByteOrder::kLittleEndian},
    {"littleendian", kLittleWords, std::nullopt},
    {"bigendian", kBigWords, std::nullopt},
    {"inverse", kLittleWords, std::nullopt},
    {"inverted", kLittleWords, std::nullopt},
    {"swapped", kLittleWords, std::nullopt},
    {"wordswap", kLittleWords, std::nullopt},
    {"swap", kLittleWords, std::nullopt},
    {"lsbfirst", kLittleWords, std::nullopt},
    {"msbfirst", kBigWords, std::nullopt},
    {"lswfirst", kLittleWords, std::nullopt},
    {"mswfirst", kBigWords, std::nullopt},
};

// "string20", "ascii16", "char[8]": size of a text.
std::optional<TypeName> text_type(std::string_view word) {
  for (const std::string_view begin : {"string", "ascii", "char", "text", "str"}) {
    if (!word.starts_with(begin)) continue;
    const auto bytes = whole_from(word.substr(begin.size()));
    if (bytes && *bytes >= 1 && *bytes <= kMaxStringBytes)
      return TypeName{.type = ValueType::kString,
                      .string_bytes = static_cast<std::uint16_t>(*bytes)};
  }
  return std::nullopt;
}

std::optional<TypeName> plain_type(std::string_view word) {
  const auto found = std::ranges::find(kNames, word, &Name::name);
  if (found != std::end(kNames)) return TypeName{.type = found->type};
  return text_type(word);
}

}  // namespace

std::optional<TypeName> type_by_name(std::string_view name) {
  std::string word;
  for (const char c : lower(name)) {
    if ((c >= 'a' && c <= 'z') || (c >= '0' && c <= '9')) word += c;
  }
  if (const auto type = plain_type(word)) return type;
  // "uint8l", "int8h": a byte of a register.
  if (word.ends_with("8l") || word.ends_with("8h")) {
    auto type = plain_type(std::string_view(word).substr(0, word.size() - 1));
    if (type && (type->type == ValueType::kInt8 || type->type == ValueType::kUint8)) {
      type->byte = word.ends_with('h') ? 1 : 0;
      return type;
    }
  }
  for (const OrderWord& order : kOrderWords) {
    std::string rest = word;
    if (!cut(rest, order.word)) continue;
    if (auto type = plain_type(rest)) {
      type->word_order = order.words;
      type->byte_order = order.bytes;
      return type;
    }
  }
  return std::nullopt;
}

std::optional<Orders> orders_by_letters(std::string_view letters) {
  constexpr auto kLittleBytes = ByteOrder::kLittleEndian;
  constexpr auto kBigBytes = ByteOrder::kBigEndian;
  const std::string word = lower(letters);
  if (word == "ab" || word == "abcd" || word == "abcdefgh") return Orders{kBigWords, kBigBytes};
  if (word == "cdab" || word == "ghefcdab") return Orders{kLittleWords, kBigBytes};
  if (word == "badc" || word == "badcfehg") return Orders{kBigWords, kLittleBytes};
  if (word == "ba" || word == "dcba" || word == "hgfedcba")
    return Orders{kLittleWords, kLittleBytes};
  return std::nullopt;
}

unsigned registers_of(ValueType type, std::uint16_t string_bytes) {
  Encoding encoding;
  encoding.type = type;
  encoding.string_bytes = string_bytes;
  return item_count(encoding, 16);
}

std::optional<ValueType> integer_of(unsigned bits, bool with_sign) {
  switch (bits) {
    case 8: return with_sign ? ValueType::kInt8 : ValueType::kUint8;
    case 16: return with_sign ? ValueType::kInt16 : ValueType::kUint16;
    case 32: return with_sign ? ValueType::kInt32 : ValueType::kUint32;
    case 64: return with_sign ? ValueType::kInt64 : ValueType::kUint64;
    default: return std::nullopt;
  }
}

}  // namespace fieldcast::importing
