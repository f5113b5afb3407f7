#include "tools/import/formats/list/list_order.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>

#include "tools/import/points/types.hpp"
#include "tools/import/text/table.hpp"

namespace fieldcast::importing {
namespace {

// Bytes in wire order, counted from 1 or 0, as letters.
struct OrderDigits {
  std::string_view word, letters;
};
constexpr OrderDigits kDigits[] = {
    {"1234", "abcd"}, {"3412", "cdab"}, {"2143", "badc"},
    {"4321", "dcba"}, {"0123", "abcd"}, {"2301", "cdab"},
    {"1032", "badc"}, {"3210", "dcba"}, {"bigendianbyteswap", "badc"}};

constexpr std::string_view kHighFirst[] = {"highfirst",  "highwordfirst",
                                           "highword",   "high",
                                           "highlow",    "hilo",
                                           "hl",         "hwf",
                                           "mswfirst",   "mswf",
                                           "msw",        "msbfirst",
                                           "msb",        "mostsignificantwordfirst",
                                           "normal",     "standard",
                                           "notswapped", "motorola"};
constexpr std::string_view kLowFirst[] = {"lowfirst",     "lowwordfirst",
                                          "lowword",      "low",
                                          "lowhigh",      "lohi",
                                          "lh",           "lwf",
                                          "lswfirst",     "lswf",
                                          "lsw",          "lsbfirst",
                                          "lsb",          "leastsignificantwordfirst",
                                          "wordswap",     "wordswapped",
                                          "wordsswapped", "swapwords",
                                          "swappedwords", "swapped",
                                          "swap",         "inverse",
                                          "inverted"};

}  // namespace

tl::expected<ListOrder, std::string> list_order_from(std::string_view cell, bool of_bytes) {
  const std::string word = column_word(cell);
  if (word.empty() || word == "none" || word == "na") return ListOrder{};
  const auto digits = std::ranges::find(kDigits, word, &OrderDigits::word);
  if (const auto orders = orders_by_letters(digits == std::end(kDigits) ? word : digits->letters))
    return ListOrder{orders->words, orders->bytes};
  for (const std::string_view big : {"big", "bigendian", "be"})
    if (word == big) return ListOrder{WordOrder::kBigEndian, std::nullopt};
  for (const std::string_view little : {"little", "littleendian", "le"})
    if (word == little) return ListOrder{WordOrder::kLittleEndian, std::nullopt, true};
  if (!of_bytes) {
    if (std::ranges::find(kHighFirst, word) != std::end(kHighFirst))
      return ListOrder{WordOrder::kBigEndian, std::nullopt};
    if (std::ranges::find(kLowFirst, word) != std::end(kLowFirst))
      return ListOrder{WordOrder::kLittleEndian, std::nullopt};
  }
  return tl::unexpected(
      fmt::format("order '{}' is not understood; say it as ABCD, CDAB, ..", cell));
}

std::optional<Access> access_from(std::string_view cell) {
  const std::string word = column_word(cell);
  // "R/WC" is written by a device command, not by a register write.
  for (const std::string_view read :
       {"", "r", "ro", "read", "readonly", "rwc", "lesen", "l", "nurlesen"})
    if (word == read) return Access::kReadOnly;
  for (const std::string_view both :
       {"rw", "wr", "readwrite", "writeread", "readandwrite", "lesenschreiben", "schreibenlesen",
        "lesenundschreiben", "ls"})
    if (word == both) return Access::kReadWrite;
  for (const std::string_view write : {"w", "wo", "write", "writeonly", "schreiben", "s"})
    if (word == write) return Access::kWriteOnly;
  return std::nullopt;
}

}  // namespace fieldcast::importing
