// Tests that the import reports what it does not understand and never guesses silently.
#include "tests/tools/import/support.hpp"
#include "tools/import/formats/list/list_cells.hpp"

namespace fieldcast::importing {
namespace {

using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::Not;

std::string place_of(const Outcome& outcome, const std::string& name) {
  const auto row = std::ranges::find(outcome.rows, name, &PointFate::name);
  if (row == outcome.rows.end()) return "not in the list";
  return row->fate == Fate::kRefused ? "no: " + row->words : row->at;
}

TEST(ImportListAddress, IsUnderstoodWholeOrNotAtAll) {
  const auto read = [](std::string_view cell) -> std::string {
    const auto address = list_address_from(cell, {});
    if (!address) return "no: " + address.error();
    std::string text = address->plain ? std::to_string(*address->plain) : "reference";
    if (address->bit) text += "." + std::to_string(*address->bit);
    if (address->registers > 0) text += " x" + std::to_string(address->registers);
    return text;
  };
  EXPECT_EQ(read("100"), "100");
  EXPECT_EQ(read("0x64"), "100");
  EXPECT_EQ(read("70 (46h)"), "70");
  EXPECT_EQ(read("40001 (0x0000)"), "reference");
  EXPECT_EQ(read("5004 - 5005"), "5004 x2");
  EXPECT_EQ(read("5033 – 5034"), "5033 x2");
  EXPECT_EQ(read("0x0010..0x0013"), "16 x4");
  EXPECT_EQ(read("40010 to 40011"), "40010 x2");
  EXPECT_EQ(read("3-4"), "3 x2");
  EXPECT_EQ(read("3-0007"), "reference");
  EXPECT_EQ(read("90,91,92,93"), "90 x4");
  EXPECT_EQ(read("80, 81"), "80 x2");
  EXPECT_EQ(read("30001/2"), "30001 x2");
  EXPECT_EQ(read("40007 Bit 3"), "40007.3");
  EXPECT_EQ(read("1234.0"), "1234.0");
  EXPECT_EQ(read("40001,00"), "40001");
  for (const char* odd : {"1,234", "1 234", "40,101", "1.000", "40.001", "1'234", "100,101"})
    EXPECT_THAT(read(odd), HasSubstr("is it one number with separators, or two?")) << odd;
  for (const char* odd :
       {"40003:6", "40003#9", "40003[7]", "40003_10", "*40010", "4 0010", "n/a", "-", "100 (0x65)",
        "100 (R)", "40003,5", "100-90", "100-400", "40001.16", "1.2E3", "40010.3-40011"})
    EXPECT_THAT(read(odd), HasSubstr("no: ")) << odd;
}

// A cell of a spreadsheet may have several lines, a text of the configuration has one.
TEST(ImportList, ADescriptionOfSeveralLinesBecomesOneLine) {
  const auto outcome = imported("meter.csv",
                                "Register,Name,Type,Unit,Description\n"
                                "40001,P,INT16,W,\"Active power\nphase 1\"\n");
  EXPECT_EQ(place_of(outcome, "P"), "holding:0");
  EXPECT_THAT(outcome.files.at(0).text, HasSubstr("Active power phase 1"));
}

TEST(ImportList, ARowThatIsNotUnderstoodDecidesNothingForTheOthers) {
  for (const char* odd : {"-", "n/a", "40003:6", "*40010", "4 0010", "see below", "\"1,234\""}) {
    const auto outcome =
        imported("meter.csv", "Register,Name,Type,Unit\n40001,A,INT16,V\n40002,B,INT16,V\n" +
                                  std::string(odd) + ",E,UINT64,Wh\n");
    EXPECT_EQ(place_of(outcome, "A"), "holding:0") << odd;
    EXPECT_EQ(place_of(outcome, "B"), "holding:1") << odd;
    EXPECT_THAT(place_of(outcome, "E"), HasSubstr("no: ")) << odd;
  }
  const auto range = import_text("meter.csv",
                                 "Register,Name,Type,Unit\n40001,A,INT16,V\n"
                                 "40010..40013,E,UINT64,Wh\n");
  EXPECT_EQ(place_of(*range, "A"), "holding:0");
  EXPECT_EQ(place_of(*range, "E"), "holding:9");
}

TEST(ImportList, RowsThatCannotBeReferencesAreNamed) {
  for (const char* odd : {"50000", "40000", "12"}) {
    const auto outcome =
        imported("meter.csv", "Register,Name,Type,Unit\n40001,A,INT16,V\n40002,B,INT16,V\n" +
                                  std::string(odd) + ",E,UINT16,Wh\n");
    EXPECT_EQ(place_of(outcome, "A"), "holding:40001");
    EXPECT_THAT(outcome.notes,
                Contains(AllOf(HasSubstr("numbers such as '40001' (line 2) are taken as they are"),
                               HasSubstr("line 4 ('" + std::string(odd) + "')"))));
  }
  const auto agree = import_text("meter.csv", "Register,Name,Type\n40001,A,INT16\n");
  EXPECT_THAT(agree->notes, Not(Contains(HasSubstr("are taken as they are"))));
}

TEST(ImportList, ASingleFunctionThatContradictsIsRefusedByItself) {
  const auto outcome = imported("meter.csv",
                                "Register,Function,Name,Type\n30001,4,Volts,FLOAT\n"
                                "30003,4,Amps,FLOAT\n40001,4,Typo,FLOAT\n40003,3,Set,FLOAT\n"
                                "4x0009,4,Odd,FLOAT\n");
  EXPECT_EQ(place_of(outcome, "Volts"), "input-register:0");
  EXPECT_EQ(place_of(outcome, "Set"), "holding:2");
  for (const char* name : {"Typo", "Odd"})
    EXPECT_THAT(place_of(outcome, name), HasSubstr("name different tables"));
}

TEST(ImportList, NumbersWithZerosInFrontAreNoCoils) {
  const auto outcome = imported("meter.csv", "Address,Name,Type\n00100,A,UINT16\n00102,B,INT32\n");
  EXPECT_EQ(place_of(outcome, "A"), "holding:100");
  EXPECT_EQ(place_of(outcome, "B"), "holding:102");
}

// Returns the type, for example "uint16", or "no: .." if the point was refused.
std::string type_of(const Outcome& outcome, const std::string& name) {
  const auto row = std::ranges::find(outcome.rows, name, &PointFate::name);
  if (row == outcome.rows.end()) return "not in the list";
  return row->fate == Fate::kRefused ? "no: " + row->words : row->type;
}

TEST(ImportList, ATypeThatSaysItsWidthKeepsIt) {
  const auto bytes = imported("meter.csv",
                              "Address,Name,Type,Length,Unit\n0,A,U16,2,V\n1,B,U32,4,V\n"
                              "3,C,FLOAT,4,V\n5,D,S16,2,V\n6,E,INT,4,V\n8,F,STRING,16,\n");
  EXPECT_EQ(type_of(bytes, "A"), "uint16");
  EXPECT_EQ(type_of(bytes, "B"), "uint32");
  EXPECT_EQ(type_of(bytes, "C"), "float32");
  EXPECT_EQ(type_of(bytes, "D"), "int16");
  EXPECT_EQ(type_of(bytes, "E"), "int32");
  EXPECT_EQ(type_of(bytes, "F"), "string(16)");
  EXPECT_EQ(bytes.count(Fate::kMoved), 6u);
  const auto words = imported("meter.csv",
                              "Address,Name,Type,Length\n0,A,U16,1\n1,B,U32,2\n3,C,REAL,4\n"
                              "7,D,BCD,2\n9,E,U16,2\n11,F,INT,3\n14,G,INT,x\n");
  EXPECT_EQ(type_of(words, "C"), "float64");
  EXPECT_EQ(type_of(words, "D"), "bcd32");
  EXPECT_EQ(type_of(words, "E"), "uint16");
  EXPECT_THAT(fate_of(words, "E"), HasSubstr("which 32 bits do not fit"));
  EXPECT_THAT(type_of(words, "F"), HasSubstr("no: no 'INT' has 48 bits"));
  EXPECT_THAT(type_of(words, "G"), HasSubstr("no: length 'x' is not understood"));
}

TEST(ImportList, ALengthMakesATypeWithoutWidthAsWide) {
  const auto outcome =
      imported("meter.csv",
               "Address,Name,Type,Size\n100,V,unsigned,16 bits\n102,P,signed,32 bits\n"
               "104,E,unsigned,64\n108,F,float,32 bit\n116,J,INT,2 words\n118,K,INT,4 bytes\n");
  EXPECT_EQ(type_of(outcome, "V"), "uint16");
  EXPECT_EQ(type_of(outcome, "P"), "int32");
  EXPECT_EQ(type_of(outcome, "E"), "uint64");
  EXPECT_EQ(type_of(outcome, "F"), "float32");
  EXPECT_EQ(type_of(outcome, "J"), "int32");
  EXPECT_EQ(type_of(outcome, "K"), "int32");
  const auto range = import_text("meter.csv", "Address,Name,Type\n100-101,A,INT\n102,B,INT\n");
  EXPECT_EQ(type_of(*range, "A"), "int32");
  EXPECT_EQ(type_of(*range, "B"), "int16");
}

TEST(ImportList, AddressesStateWhatALengthCountsWhereNoTypeDoes) {
  const auto list = [](const char* second, const char* third) {
    const auto outcome =
        import_text("meter.csv", std::string("Address,Name,Type,Length\n0,A,INT,2\n") + second +
                                     ",B,INT,2\n" + third + ",C,INT,2\n");
    return type_of(*outcome, "A") + ", " + fate_of(*outcome, "A");
  };
  EXPECT_EQ(list("1", "2"), "int16, ok");
  EXPECT_EQ(list("2", "4"), "int32, ok");
  EXPECT_EQ(list("10", "20"), "int32, length 2 is taken as registers");
}

TEST(ImportList, AColumnTypeMayNameTheTables) {
  for (const char* title : {"Data Type", "Format", "Data Format"}) {
    const auto outcome = imported(
        "meter.csv", std::string("Address,Name,Type,") + title +
                         ",Unit\n0,A,Holding Register,FLOAT32,V\n2,B,Input Register,INT32,V\n"
                         "4,C,Coil,BOOL,\n5,D,Discrete Input,BOOL,\n6,E,Coil,UINT16,\n");
    EXPECT_EQ(place_of(outcome, "A") + type_of(outcome, "A"), "holding:0float32");
    EXPECT_EQ(place_of(outcome, "B") + type_of(outcome, "B"), "input-register:2int32");
    EXPECT_EQ(place_of(outcome, "C") + type_of(outcome, "C"), "coil:4bool");
    EXPECT_EQ(place_of(outcome, "D") + type_of(outcome, "D"), "input:5bool");
    EXPECT_THAT(place_of(outcome, "E"), HasSubstr("no: data type 'UINT16' in a table of single"));
  }
}

TEST(ImportList, WordsThatOnlyBeginLikeATypeAreNone) {
  const auto outcome = imported("meter.csv",
                                "Address,Name,Data Format,Unit\n4,c,2 Words,\n6,d,3 bananas,\n"
                                "8,e,4Q_FP_PF,\n9,f,bananas,\n10,g,2,\n12,h,,\n13,i,INT16U,\n");
  EXPECT_EQ(type_of(outcome, "c"), "uint32");
  for (const char* name : {"d", "e", "f", "g"})
    EXPECT_THAT(type_of(outcome, name), HasSubstr("is unknown")) << name;
  EXPECT_EQ(type_of(outcome, "h"), "uint16");
  EXPECT_EQ(type_of(outcome, "i"), "uint16");
  EXPECT_THAT(outcome.notes, Contains(HasSubstr("without a data type are taken for unsigned")));
}

TEST(ImportList, ValuesOnPartsOfTheSameRegistersHaveANote) {
  const auto outcome = imported("meter.csv",
                                "Address,Name,Type,Slave\n0,A,U32,1\n1,B,U32,1\n3,C,U16,1\n"
                                "3,C again,S16,1\n10.1,bit,BOOL,1\n10.1,other,BOOL,1\n"
                                "10,word,U16,1\n0,D,U16,2\n");
  EXPECT_EQ(fate_of(outcome, "A"), "lies on registers of 'B' (line 3) too");
  EXPECT_EQ(fate_of(outcome, "B"), "lies on registers of 'A' (line 2) too");
  EXPECT_EQ(fate_of(outcome, "bit"), "is the bit of 'other' (line 7) too");
  for (const char* name : {"C", "C again", "word", "D"}) EXPECT_EQ(fate_of(outcome, name), "ok");
}

TEST(ImportListFactor, IsUnderstoodInManyForms) {
  const auto read = [](std::string_view cell, NumberStyle style = {}) {
    const auto factor = factor_from(cell, style);
    return factor && *factor ? (*factor)->value : 0;
  };
  for (const char* tenth :
       {"0.1",  "0,1",     "x0.1",  "×0.1",     "* 0,1",  "1/10",      "/10",
        "÷10",  ":10",     "10^-1", "10⁻¹",     "10**-1", "1 × 10^-1", "1 x 10-1",
        "1E-1", "1 = 0.1", "0.1 V", "0.1A/bit", "1:10",   "10^(-1)"})
    EXPECT_DOUBLE_EQ(read(tenth), 0.1) << tenth;
  for (const char* thousand : {"10^3", "10³", "1e3", "x 1000"})
    EXPECT_DOUBLE_EQ(read(thousand), 1000) << thousand;
  EXPECT_DOUBLE_EQ(read("2^-7"), 1.0 / 128);
  EXPECT_EQ(factor_from("0.01 kWh", {})->value().unit, "kWh");
  for (const char* none : {"", "-", "none", "n/a"})
    EXPECT_FALSE(factor_from(none, {})->has_value());
  for (const char* odd : {"10-2", "0.1*n", "val/10", "0.1 .. 1", "0.01, signed", "FIX2", "0", "/0",
                          "0.1 = 1", "1.000,5", "1,000", "10^0.5", "10^99"})
    EXPECT_FALSE(factor_from(odd, {})) << odd;
}

TEST(ImportListFactor, OtherRowsStateWhatACommaMeans) {
  NumberStyle german, english;
  german.learn("0,1");
  english.learn("0.25");
  EXPECT_DOUBLE_EQ((*factor_from("1,000", german))->value, 1);
  EXPECT_FALSE(factor_from("1.000", german));
  EXPECT_FALSE(factor_from("1,000", english));
  EXPECT_DOUBLE_EQ((*factor_from("1.000", english))->value, 1);
}

TEST(ImportList, FactorsThatAreNotUnderstoodAreRefused) {
  const auto outcome = imported(
      "meter.csv",
      "Address,Name,Type,Scale,Decimals,Offset,Unit\n0,A,INT16,10^-1,,,V\n1,B,INT16,val/10,,,V\n"
      "2,C,INT16,1%,,,V\n3,D,INT16,,2,,V\n4,E,INT16,,0.1,,V\n5,F,INT16,,0.00,,V\n"
      "6,G,INT16,,x.xx,,V\n7,H,INT16,,-1,,V\n8,I,INT16,0.5,2,,V\n9,J,INT16,0.1,1,,V\n"
      "10,K,INT16,,,about 4,V\n");
  EXPECT_THAT(channel_line(outcome, "A"), HasSubstr("scale: 0.1,"));
  EXPECT_EQ(fate_of(outcome, "B"), "no: scale 'val/10' is no number");
  EXPECT_THAT(fate_of(outcome, "C"), HasSubstr("no: scale '1%' names another unit than 'V'"));
  expect_channels(outcome, {"D -> scale: 0.01,", "E -> scale: 0.1,"});
  EXPECT_EQ(fate_of(outcome, "E"), "decimals '0.1' is taken for the resolution");
  for (const char* name : {"F", "G", "H"})
    EXPECT_THAT(fate_of(outcome, name), HasSubstr("is no count of places")) << name;
  EXPECT_EQ(fate_of(outcome, "I"), "decimals '2' is left out, the scale is taken");
  EXPECT_EQ(fate_of(outcome, "J"), "ok");
  EXPECT_EQ(fate_of(outcome, "K"), "no: offset 'about 4' is no number");
}

TEST(ImportOutcome, ShowsWhatAChannelMakesOfItsRegisters) {
  const auto outcome = imported("meter.csv",
                                "Address,Name,Type,Scale,Offset,Word Order,Access\n"
                                "0,A,FLOAT,0.1,-4,CDAB,R/W\n2,B,UINT16,1,,,R\n"
                                "3,C,UINT32,,,DCBA,R\n");
  EXPECT_EQ(settings_of(outcome.rows[0]), "scale 0.1, offset -4, low word first, read-write");
  EXPECT_EQ(settings_of(outcome.rows[1]), "");
  EXPECT_EQ(settings_of(outcome.rows[2]), "low word first, low byte first");
}

TEST(ImportArea, IsNamedInManyWaysOrNotUnderstood) {
  const auto read = [](std::string_view cell) {
    const auto area = area_by_name(cell);
    return area ? address_text(*area, 0) : "none";
  };
  for (const char* holding :
       {"03", "FC03", "0x03", "F3", "Holding Register (R/W)", "(R/W) Holding", "03/06", "3, 6, 16",
        "Halteregister", "HR", "4X", "Preset multiple registers", "23", "10h", "0x10",
        "3 (Holding register)", "3 (read), 16 (write)"})
    EXPECT_EQ(read(holding), "holding:0") << holding;
  for (const char* input : {"Eingangsregister", "04", "FC 4", "F4", "04h", "3x", "Input Registers",
                            "Read Input Registers (04)", "Analogeingang"})
    EXPECT_EQ(read(input), "input-register:0") << input;
  for (const char* coil : {"Spule", "01/05", "Coil", "1, 15"})
    EXPECT_EQ(read(coil), "coil:0") << coil;
  for (const char* bits : {"Discrete Input", "FC02", "Digitaleingang"})
    EXPECT_EQ(read(bits), "input:0") << bits;
  for (const char* odd : {"Foo", "Eingang", "Read", "7", "3/4", "1/6", "2/3", "Status", "3 bananas",
                          "Input/Holding", "Input register (03)", "Coil or holding", ""})
    EXPECT_EQ(read(odd), "none") << odd;
}

TEST(ImportList, WordsThatAreNotUnderstoodAreRefusedOrReported) {
  const auto outcome =
      imported("meter.csv",
               "Address,Name,Type,Table,Word Order,Access,Slave,Bit,Refresh\n"
               "0,A,FLOAT,Foo,,,,,\n2,B,FLOAT,7,,,,,\n4,C,FLOAT,Eingangsregister,,,,,\n"
               "6,D,FLOAT,HR,swapped,,,,\n8,E,FLOAT,HR,LSB first,,,,\n10,F,FLOAT,HR,low/high,,,,\n"
               "12,G,FLOAT,HR,R1:R0,,,,\n14,H,FLOAT,HR,Intel,,,,\n16,I,FLOAT,HR,3412,,,,\n"
               "18,J,FLOAT,HR,bananas,,,,\n20,K,FLOAT,HR,little endian,,,,\n"
               "22,L,FLOAT,HR,,maybe,,,\n24,M,FLOAT,HR,,lesen/schreiben,,,\n"
               "28,O,UINT16,HR,,,,0-3,\n30,P,UINT16,HR,,,,,fast\n26,N,FLOAT,HR,,,300,,\n");
  for (const char* name : {"A", "B"})
    EXPECT_THAT(fate_of(outcome, name), HasSubstr("no: table or function '")) << name;
  EXPECT_EQ(place_of(outcome, "C"), "input-register:4");
  for (const char* name : {"D", "E", "F", "I", "K"})
    EXPECT_THAT(channel_line(outcome, name), HasSubstr("word-order: little-endian")) << name;
  for (const char* name : {"G", "H", "J"})
    EXPECT_THAT(fate_of(outcome, name), HasSubstr("no: order '")) << name;
  expect_fates(outcome, {"K -> is taken for: low word first",
                         "L -> access 'maybe' is not understood: read-only"});
  EXPECT_THAT(channel_line(outcome, "M"), HasSubstr("access: read-write"));
  expect_fates(outcome,
               {"N -> no: '300' is no address of a device", "O -> no: bit '0-3' is not 0 to 15",
                "P -> refresh 'fast' is no number of ms"});
}

TEST(ImportList, AnOrderOfTheUserIsForValuesWhoseListSaysNone) {
  ImportOptions options;
  options.word_order = WordOrder::kLittleEndian;
  const auto outcome =
      imported("meter.csv", "Address,Name,Type,Word Order\n0,A,FLOAT,ABCD\n2,B,FLOAT,\n", options);
  EXPECT_THAT(channel_line(outcome, "A"), Not(HasSubstr("word-order")));
  EXPECT_THAT(channel_line(outcome, "B"), HasSubstr("word-order: little-endian"));
}

TEST(ImportList, TitlesMayHaveUmlautsAndRemarks) {
  for (const auto& [scale, length] :
       {std::pair("Auflösung", "Länge"), std::pair("AUFLÖSUNG", "Länge (Bytes)"),
        std::pair("Aufloesung", "Laenge"), std::pair("Auflosung", "Lange")}) {
    const auto outcome =
        import_text("meter.csv", std::string("Adresse;Bezeichnung;Datentyp;") + scale +
                                     ";Einheit;" + length + "\n40001;Vorlauf;INT;0,1;C;32 bit\n");
    ASSERT_TRUE(outcome) << outcome.error();
    EXPECT_EQ(channel_line(*outcome, "Vorlauf"),
              "{ name: Vorlauf, at: \"holding:0\", type: int32, scale: 0.1, unit: C }");
  }
  const auto place = [](const std::string& titles, const std::string& cells) {
    const auto outcome = import_text("meter.csv", titles + ",Name,Type\n" + cells + ",A,UINT16\n");
    return outcome ? place_of(*outcome, "A") : outcome.error();
  };
  EXPECT_EQ(place("Reg. Addr (dec),Reg. Addr (hex)", "4096,1000"), "holding:4096");
  EXPECT_EQ(place("Adresse hex,Adresse dez.", "1000,4096"), "holding:4096");
  EXPECT_EQ(place("Register (1-based)", "1"), "holding:0");
  EXPECT_EQ(place("Register (1-based)", "40001"), "holding:0");
  EXPECT_THAT(place("Register (1-based)", "0"), HasSubstr("no: the addresses of the list count"));
  EXPECT_EQ(place("Address (0-based)", "40001"), "holding:40001");
  EXPECT_EQ(place("PLC Address,Protocol Address", "30002,1"), "input-register:1");
  EXPECT_EQ(place("Start,End", "100,101"), "holding:100");
}

TEST(ImportList, HexadecimalAddressesWithoutAMarkAreReadAsAWhole) {
  const auto whole = imported(
      "meter.csv", "Address,Name,Type\n0000,A,FLOAT\n000C,B,FLOAT\n0012,C,FLOAT\n001E,D,FLOAT\n");
  EXPECT_EQ(place_of(whole, "B"), "holding:12");
  EXPECT_EQ(place_of(whole, "C"), "holding:18");
  EXPECT_EQ(place_of(whole, "D"), "holding:30");
  EXPECT_THAT(whole.notes,
              Contains(HasSubstr("all addresses are hexadecimal, as '000C' (line 3)")));
  const auto odd =
      import_text("meter.csv", "Address,Name,Type\n100,A,U16\n101,B,U16\n102a,C,U16\n");
  EXPECT_EQ(place_of(*odd, "A"), "holding:100");
  EXPECT_THAT(place_of(*odd, "C"), HasSubstr("no: "));
  EXPECT_THAT(odd->notes, Contains(HasSubstr("'102a' (line 4) may be hexadecimal")));
  const auto marked =
      import_text("meter.csv", "Address,Name,Type\n000CH,A,FLOAT\n0012,B,FLOAT\n256,C,FLOAT\n");
  EXPECT_EQ(place_of(*marked, "A"), "holding:12");
  EXPECT_THAT(place_of(*marked, "B"), HasSubstr("no: address '0012' may be hexadecimal"));
  EXPECT_THAT(fate_of(*marked, "C"), HasSubstr("'256' is read as decimal"));
}

TEST(ImportList, AGainBelowOneMultiplies) {
  const auto list = [](const std::string& first, const std::string& second) {
    return import_text("meter.csv", "Address,Name,Type,Gain\n0,A,INT16," + first + "\n1,B,INT16," +
                                        second + "\n2,C,INT16,1\n");
  };
  EXPECT_EQ(settings_of(list("10", "100")->rows[0]), "scale 0.1");
  EXPECT_THAT(list("10", "100")->notes, Contains(HasSubstr("values are divided by it")));
  EXPECT_EQ(settings_of(list("0.1", "0.01")->rows[0]), "scale 0.1");
  EXPECT_THAT(list("0.1", "0.01")->notes, Contains(HasSubstr("values are multiplied by it")));
  const auto both = list("10", "0.1");
  for (const char* name : {"A", "B"})
    EXPECT_THAT(fate_of(*both, name), HasSubstr("unclear whether to divide or to multiply"));
  EXPECT_EQ(fate_of(*both, "C"), "ok");
}

TEST(ImportList, EachFileWithoutAnAddressIsADevice) {
  const auto list = [](const std::string& file, const std::string& name) {
    return InputFile{file, "Name,Address,Type\n" + name + ",7,uint16\n"};
  };
  const Outcome outcome =
      imported_files({list("north/tank-b.csv", "flow"), list("tank.csv", "level"),
                      list("south/tank-b.csv", "heat")});
  const std::string& text = outcome.files.front().text;
  EXPECT_THAT(text, HasSubstr("name: tank-b\n        address: 1\n"));
  EXPECT_THAT(text, HasSubstr("name: tank\n        address: 2\n"));
  EXPECT_THAT(text, HasSubstr("name: tank-b-2\n        address: 3\n"));
}

TEST(ImportList, ABlankSlaveIsThatOfTheRowAbove) {
  const auto outcome = imported("meter.csv",
                                "Register,Name,Type,Slave\n40001,A,INT16,3\n40002,B,INT16,\n"
                                "40001,D,INT16,4\n40002,E,INT16,x\n40003,F,INT16,\n");
  ASSERT_EQ(outcome.rows.size(), 5u);
  EXPECT_EQ(outcome.rows[1].channel, "bus-1/meter-3/B");
  EXPECT_THAT(outcome.notes, Contains(HasSubstr("(line 3, ..) are taken to have that of the row")));
  expect_fates(outcome,
               {"E -> no: 'x' is no address of a device", "F -> no: no address of its device"});
}

}  // namespace
}  // namespace fieldcast::importing
