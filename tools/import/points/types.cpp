#include "tools/import/points/types.hpp"

#include "tools/import/text/text.hpp"

namespace fieldcast::importing {
namespace {

constexpr Words<ValueType> kNames[] = {
    {"bool boolean bit coil binary digital onoff discrete", ValueType::kBool},
    {"int8 s8 i8 sint8 sint char", ValueType::kInt8},
    {"uint8 u8 usint byte uchar", ValueType::kUint8},
    {"int16 s16 i16 sint16 short signedshort int integer signed signed16 16bitsigned "
     "16bitint signedint16 16bitsignedinteger signed16bit 16bitinteger signedint "
     "signed16bitinteger",
     ValueType::kInt16},
    {"uint16 u16 ushort unsignedshort word uint unsigned unsigned16 16bitunsigned 16bituint "
     "16bitunsignedinteger unsigned16bit unsignedint16 unsignedint unsigned16bitinteger "
     "unsignedinteger enum enum16 bitfield16 bitmap bitmap16 acc16 register int16u",
     ValueType::kUint16},
    {"int32u uint32 u32 dword udint ulong unsigned32 32bitunsigned 32bituint unsignedlong "
     "32bitunsignedinteger unsigned32bit unsignedint32 unsigned32bitinteger acc32 "
     "bitfield32 enum32",
     ValueType::kUint32},
    {"int64u uint64 u64 qword lword ulint unsigned64 64bitunsigned 64bituint unsigned64bit "
     "64bitunsignedinteger acc64",
     ValueType::kUint64},
    {"int32 s32 i32 sint32 dint long longint signed32 32bitsigned 32bitint signedint32 "
     "32bitsignedinteger signed32bit 32bitinteger signedlong signed32bitinteger",
     ValueType::kInt32},
    {"int64 s64 i64 sint64 lint llong longlong signed64 64bitsigned 64bitint signed64bit "
     "64bitsignedinteger",
     ValueType::kInt64},
    {"float float32 f32 real real32 single flt32 32bitfloat float32bit ieee754 "
     "floatingpoint 32bitreal floatieee754 32bitfloatingpoint float32ieee ieee754float "
     "ieeefloat",
     ValueType::kFloat32},
    {"double float64 f64 lreal real64 64bitfloat 64bitreal float64ieee 64bitfloatingpoint",
     ValueType::kFloat64},
    {"bcd8", ValueType::kBcd8},
    {"bcd bcd16 16bitbcd", ValueType::kBcd16},
    {"lbcd bcd32 32bitbcd", ValueType::kBcd32},
    {"string text ascii str utf8", ValueType::kString}};

constexpr auto kLittleWords = WordOrder::kLittleEndian;
constexpr auto kBigWords = WordOrder::kBigEndian;
constexpr auto kLittleBytes = ByteOrder::kLittleEndian;
constexpr auto kBigBytes = ByteOrder::kBigEndian;

struct OrderWords {
  std::string_view words;
  WordOrder word_order;
  std::optional<ByteOrder> byte_order;
};
constexpr OrderWords kOrderWords[] = {
    {"lebs dcba", kLittleWords, kLittleBytes},
    {"bebs badc", kBigWords, kLittleBytes},
    {"le cdab", kLittleWords, kBigBytes},
    {"be abcd", kBigWords, kBigBytes},
    {"littleendian inverse inverted swapped wordswap swap lsbfirst lswfirst", kLittleWords, {}},
    {"bigendian msbfirst mswfirst", kBigWords, {}}};

constexpr Words<Orders> kLetters[] = {{"ab abcd abcdefgh", {kBigWords, kBigBytes}},
                                      {"cdab ghefcdab", {kLittleWords, kBigBytes}},
                                      {"badc badcfehg", {kBigWords, kLittleBytes}},
                                      {"ba dcba hgfedcba", {kLittleWords, kLittleBytes}}};

// "string20", "ascii16", "char[8]": size of a text.
std::optional<TypeName> text_type(std::string_view word) {
  for (const std::string_view begin : {"string", "ascii", "char", "text", "str"}) {
    if (!word.starts_with(begin)) continue;
    const auto bytes = whole_from(word.substr(begin.size()), 1, kMaxStringBytes);
    if (bytes)
      return TypeName{.type = ValueType::kString,
                      .string_bytes = static_cast<std::uint16_t>(*bytes)};
  }
  return std::nullopt;
}

std::optional<TypeName> plain_type(std::string_view word) {
  if (const auto type = value_of(kNames, word)) return TypeName{.type = *type};
  return text_type(word);
}

}  // namespace

std::optional<TypeName> type_by_name(std::string_view name) {
  std::string letters = lower(name);
  std::erase_if(letters, [](char c) { return !is_digit(c) && (c < 'a' || c > 'z'); });
  const std::string_view word = letters;
  if (const auto type = plain_type(word)) return type;
  // "uint8l", "int8h": a byte of a register.
  if (word.ends_with("8l") || word.ends_with("8h")) {
    auto type = plain_type(word.substr(0, word.size() - 1));
    if (type && is_byte(type->type)) {
      type->byte = word.ends_with('h') ? 1 : 0;
      return type;
    }
  }
  for (const OrderWords& order : kOrderWords) {
    for (const std::string_view end : split(order.words, ' ')) {
      if (!word.ends_with(end)) continue;
      auto type = plain_type(word.substr(0, word.size() - end.size()));
      if (!type) continue;
      type->word_order = order.word_order;
      type->byte_order = order.byte_order;
      return type;
    }
  }
  return std::nullopt;
}

std::optional<Orders> orders_by_letters(std::string_view letters) {
  return value_of(kLetters, lower(letters));
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
