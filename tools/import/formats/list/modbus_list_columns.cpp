#include "tools/import/formats/list/modbus_list_columns.hpp"

#include <algorithm>
#include <iterator>
#include <utility>

#include "tools/import/text/text.hpp"

namespace fieldcast::importing {
namespace {

constexpr Words<Field> kListColumns[] = {
    {"name tagname tag signal signalname parameter parametername variable variablename "
     "registername measurement quantity point pointname label item symbol bezeichnung "
     "messwert nom nombre nome designation variableengunit",
     Field::kName},
    {"address adress addr adresse modbusaddress modbusadresse register registeraddress "
     "addressregister registernumber registerno regaddr reg registre registro startaddress "
     "startregister modbusregister modbusreg dataaddress addressdec protocoladdress "
     "plcaddress physicaladdress modiconaddress modicomaddress parameterregister pduaddress "
     "start startaddr startreg startadresse startingaddress registeradresse registernummer "
     "registeraddr regaddress regadresse modbusregisteraddress addressdecimal decaddress "
     "addresshex hexaddress direccion indirizzo",
     Field::kAddress},
    {"function functioncode fc modbusfunction modbusfunctioncode functioncoderead "
     "readfunction readfc funktion funktionscode registertype regtype area table objecttype "
     "datatable registertable registertyp tabelle kind",
     Field::kArea},
    {"type datatype dataformat format datentyp datenformat typ valuetype encoding tipo "
     "typededonnees",
     Field::kType},
    {"access rw readwrite readandwrite accesstype accessmode zugriff zugriffsart "
     "lesenschreiben permission attribute mode",
     Field::kAccess},
    {"scale scaling factor scalefactor scalingfactor multiplier faktor skalierung "
     "resolution res coefficient auflosung aufloesung multiplikator mult",
     Field::kScale},
    {"gain divisor divider teiler", Field::kDivisor},
    {"decimals decimalplaces nachkommastellen kommastellen", Field::kDecimals},
    {"offset valueoffset bias", Field::kOffset},
    {"unit units einheit engunit engunits engineeringunits uom unite unita unidad", Field::kUnit},
    {"description details beschreibung comment kommentar remark bemerkung remarks notes "
     "note",
     Field::kDescription},
    {"bit bitposition bitnumber", Field::kBit},
    {"length size count registers numberofregisters noofregisters numregisters "
     "quantityofregisters words anzahl lange laenge bytes bits",
     Field::kLength},
    {"wordorder byteorder endian wortreihenfolge bytereihenfolge endianness order",
     Field::kWordOrder},
    {"slave slaveid slaveaddress unitid deviceid deviceaddress slaveadresse geraeteadresse",
     Field::kDevice},
    {"refresh pollinterval interval scanrate pollms refreshms", Field::kRefresh}};

// Letters of other languages, spelled as in the words above.
constexpr std::pair<std::string_view, std::string_view> kLetters[] = {
    {"ä", "ae"}, {"ö", "oe"}, {"ü", "ue"}, {"Ä", "ae"}, {"Ö", "oe"},
    {"Ü", "ue"}, {"ß", "ss"}, {"é", "e"},  {"è", "e"},  {"ó", "o"},
    {"ñ", "n"},  {"à", "a"},  {"á", "a"},  {"í", "i"},  {"ç", "c"}};

// Suffixes allowed after the word of a title.
constexpr std::string_view kRemarks[] = {
    "dec",         "decimal", "dez",    "dezimal",   "hex",       "hexadecimal",
    "hexadezimal", "1based",  "0based", "onebased",  "zerobased", "base1",
    "base0",       "words",   "bytes",  "registers", "bits",      "ms"};

bool is_known(std::string_view word) { return value_of(kListColumns, word).has_value(); }

std::string list_title_word(std::string_view title) {
  std::string text = lower(title);
  for (const auto& [letter, plain] : kLetters) {
    for (std::size_t at = text.find(letter); at != std::string::npos; at = text.find(letter, at))
      text.replace(at, letter.size(), plain);
  }
  const std::string word = column_word(text);
  if (is_known(word)) return word;
  // "Reg. Addr (dec)", "Adresse hex", "Register (1-based)", "Length (words)"
  for (const std::string_view end : kRemarks) {
    if (word.ends_with(end) && is_known(word.substr(0, word.size() - end.size())))
      return word.substr(0, word.size() - end.size());
  }
  return word;
}

}  // namespace

// If no other column has the address, "offset" is the register, as in Siemens lists.
Columns list_columns(const Row& header) {
  Columns columns(header, kListColumns, list_title_word);
  const auto offset = columns.index_of(Field::kOffset);
  if (offset && !columns.has(Field::kAddress) &&
      list_title_word(header.cell(*offset)) == "offset") {
    columns.set(Field::kAddress, offset);
    columns.set(Field::kOffset, std::nullopt);
  }
  return columns;
}

std::optional<unsigned> first_address_of_title(std::string_view title) {
  const std::string word = column_word(title);
  const auto has = [&](std::string_view part) { return word.find(part) != std::string::npos; };
  if (has("1based") || has("onebased") || has("base1")) return 1;
  if (has("0based") || has("zerobased") || has("base0") || has("protocol") || has("pdu")) return 0;
  return std::nullopt;
}

}  // namespace fieldcast::importing
