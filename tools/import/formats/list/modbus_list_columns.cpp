#include "tools/import/formats/list/modbus_list_columns.hpp"

#include <algorithm>
#include <iterator>
#include <utility>

#include "tools/import/text/text.hpp"

namespace fieldcast::importing {
namespace {

constexpr ColumnName kListColumns[] = {
    {"name", Field::kName},
    {"tagname", Field::kName},
    {"tag", Field::kName},
    {"signal", Field::kName},
    {"signalname", Field::kName},
    {"parameter", Field::kName},
    {"parametername", Field::kName},
    {"variable", Field::kName},
    {"variablename", Field::kName},
    {"registername", Field::kName},
    {"measurement", Field::kName},
    {"quantity", Field::kName},
    {"point", Field::kName},
    {"pointname", Field::kName},
    {"label", Field::kName},
    {"item", Field::kName},
    {"symbol", Field::kName},
    {"bezeichnung", Field::kName},
    {"messwert", Field::kName},
    {"nom", Field::kName},
    {"nombre", Field::kName},
    {"nome", Field::kName},
    {"designation", Field::kName},
    {"variableengunit", Field::kName},  // Carlo Gavazzi
    {"address", Field::kAddress},
    {"adress", Field::kAddress},
    {"addr", Field::kAddress},
    {"adresse", Field::kAddress},
    {"modbusaddress", Field::kAddress},
    {"modbusadresse", Field::kAddress},
    {"register", Field::kAddress},
    {"registeraddress", Field::kAddress},
    {"addressregister", Field::kAddress},
    {"registernumber", Field::kAddress},
    {"registerno", Field::kAddress},
    {"regaddr", Field::kAddress},
    {"reg", Field::kAddress},
    {"registre", Field::kAddress},
    {"registro", Field::kAddress},
    {"startaddress", Field::kAddress},
    {"startregister", Field::kAddress},
    {"modbusregister", Field::kAddress},
    {"modbusreg", Field::kAddress},
    {"dataaddress", Field::kAddress},
    {"addressdec", Field::kAddress},
    {"protocoladdress", Field::kAddress},
    {"plcaddress", Field::kAddress},
    {"physicaladdress", Field::kAddress},
    {"modiconaddress", Field::kAddress},
    {"modicomaddress", Field::kAddress},
    {"parameterregister", Field::kAddress},
    {"pduaddress", Field::kAddress},
    {"start", Field::kAddress},
    {"startaddr", Field::kAddress},
    {"startreg", Field::kAddress},
    {"startadresse", Field::kAddress},
    {"startingaddress", Field::kAddress},
    {"registeradresse", Field::kAddress},
    {"registernummer", Field::kAddress},
    {"registeraddr", Field::kAddress},
    {"regaddress", Field::kAddress},
    {"regadresse", Field::kAddress},
    {"modbusregisteraddress", Field::kAddress},
    {"addressdecimal", Field::kAddress},
    {"decaddress", Field::kAddress},
    {"addresshex", Field::kAddress},
    {"hexaddress", Field::kAddress},
    {"direccion", Field::kAddress},
    {"indirizzo", Field::kAddress},
    {"function", Field::kArea},
    {"functioncode", Field::kArea},
    {"fc", Field::kArea},
    {"modbusfunction", Field::kArea},
    {"modbusfunctioncode", Field::kArea},
    {"functioncoderead", Field::kArea},
    {"readfunction", Field::kArea},
    {"readfc", Field::kArea},
    {"funktion", Field::kArea},
    {"funktionscode", Field::kArea},
    {"registertype", Field::kArea},
    {"regtype", Field::kArea},
    {"area", Field::kArea},
    {"table", Field::kArea},
    {"objecttype", Field::kArea},
    {"datatable", Field::kArea},
    {"registertable", Field::kArea},
    {"registertyp", Field::kArea},
    {"tabelle", Field::kArea},
    {"kind", Field::kArea},
    {"type", Field::kType},
    {"datatype", Field::kType},
    {"dataformat", Field::kType},
    {"format", Field::kType},
    {"datentyp", Field::kType},
    {"datenformat", Field::kType},
    {"typ", Field::kType},
    {"valuetype", Field::kType},
    {"encoding", Field::kType},
    {"tipo", Field::kType},
    {"typededonnees", Field::kType},
    {"access", Field::kAccess},
    {"rw", Field::kAccess},
    {"readwrite", Field::kAccess},
    {"readandwrite", Field::kAccess},
    {"accesstype", Field::kAccess},
    {"accessmode", Field::kAccess},
    {"zugriff", Field::kAccess},
    {"zugriffsart", Field::kAccess},
    {"lesenschreiben", Field::kAccess},
    {"permission", Field::kAccess},
    {"attribute", Field::kAccess},
    {"mode", Field::kAccess},
    {"scale", Field::kScale},
    {"scaling", Field::kScale},
    {"factor", Field::kScale},
    {"scalefactor", Field::kScale},
    {"scalingfactor", Field::kScale},
    {"multiplier", Field::kScale},
    {"faktor", Field::kScale},
    {"skalierung", Field::kScale},
    {"resolution", Field::kScale},
    {"res", Field::kScale},
    {"coefficient", Field::kScale},
    {"auflosung", Field::kScale},
    {"aufloesung", Field::kScale},
    {"multiplikator", Field::kScale},
    {"mult", Field::kScale},
    {"gain", Field::kDivisor},
    {"divisor", Field::kDivisor},
    {"divider", Field::kDivisor},
    {"teiler", Field::kDivisor},
    {"decimals", Field::kDecimals},
    {"decimalplaces", Field::kDecimals},
    {"nachkommastellen", Field::kDecimals},
    {"kommastellen", Field::kDecimals},
    {"offset", Field::kOffset},
    {"valueoffset", Field::kOffset},
    {"bias", Field::kOffset},
    {"unit", Field::kUnit},
    {"units", Field::kUnit},
    {"einheit", Field::kUnit},
    {"engunit", Field::kUnit},
    {"engunits", Field::kUnit},
    {"engineeringunits", Field::kUnit},
    {"uom", Field::kUnit},
    {"unite", Field::kUnit},
    {"unita", Field::kUnit},
    {"unidad", Field::kUnit},
    {"description", Field::kDescription},
    {"details", Field::kDescription},
    {"beschreibung", Field::kDescription},
    {"comment", Field::kDescription},
    {"kommentar", Field::kDescription},
    {"remark", Field::kDescription},
    {"bemerkung", Field::kDescription},
    {"remarks", Field::kDescription},
    {"notes", Field::kDescription},
    {"note", Field::kDescription},
    {"bit", Field::kBit},
    {"bitposition", Field::kBit},
    {"bitnumber", Field::kBit},
    {"length", Field::kLength},
    {"size", Field::kLength},
    {"count", Field::kLength},
    {"registers", Field::kLength},
    {"numberofregisters", Field::kLength},
    {"noofregisters", Field::kLength},
    {"numregisters", Field::kLength},
    {"quantityofregisters", Field::kLength},
    {"words", Field::kLength},
    {"anzahl", Field::kLength},
    {"lange", Field::kLength},
    {"laenge", Field::kLength},
    {"bytes", Field::kLength},
    {"bits", Field::kLength},
    {"wordorder", Field::kWordOrder},
    {"byteorder", Field::kWordOrder},
    {"endian", Field::kWordOrder},
    {"wortreihenfolge", Field::kWordOrder},
    {"bytereihenfolge", Field::kWordOrder},
    {"endianness", Field::kWordOrder},
    {"order", Field::kWordOrder},
    {"slave", Field::kDevice},
    {"slaveid", Field::kDevice},
    {"slaveaddress", Field::kDevice},
    {"unitid", Field::kDevice},
    {"deviceid", Field::kDevice},
    {"deviceaddress", Field::kDevice},
    {"slaveadresse", Field::kDevice},
    {"geraeteadresse", Field::kDevice},
    {"refresh", Field::kRefresh},
    {"pollinterval", Field::kRefresh},
    {"interval", Field::kRefresh},
    {"scanrate", Field::kRefresh},
    {"pollms", Field::kRefresh},
    {"refreshms", Field::kRefresh},
};

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

bool is_known(std::string_view word) {
  return std::ranges::find(kListColumns, word, &ColumnName::word) != std::end(kListColumns);
}

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
