#include "tests/tools/import/support.hpp"
#include "tools/import/points/address.hpp"
#include "tools/import/points/types.hpp"
#include "tools/import/text/table.hpp"

namespace fieldcast::importing {
namespace {

using testing::HasSubstr;

const std::string kKepware =
    "Tag Name,Address,Data Type,Respect Data Type,Client Access,Scan Rate,Scaling,Raw Low,Raw "
    "High,Scaled Low,Scaled High,Scaled Data Type,Clamp Low,Clamp High,Eng Units,Description,"
    "Negate Value\n";

std::string utf16(const std::string& ascii, bool big) {
  std::string bytes = big ? "\xFE\xFF" : "\xFF\xFE";
  for (const char c : ascii) {
    if (big) bytes += '\0';
    bytes += c;
    if (!big) bytes += '\0';
  }
  return bytes;
}

TEST(ImportText, SpreadsheetsSaveItInManyEncodings) {
  const std::string list = "Register;Name;Type;Unit\r\n40001;Power;UINT16;kW\r\n";
  const std::string windows =
      "Register;Name;Type;Unit\r\n40001;Power;UINT16;\xB0"
      "C\r\n";
  for (const std::string& bytes :
       {list, "\xEF\xBB\xBF" + list, utf16(list, false), utf16(list, true),
        utf16(list, false).substr(2), "sep=;\r\n" + list}) {
    const auto outcome = imported("meter.csv", bytes);
    EXPECT_EQ(channel_line(outcome, "Power"),
              "{ name: Power, at: \"holding:0\", type: uint16, unit: kW }");
  }
  EXPECT_THAT(channel_line(*import_text("meter.csv", windows), "Power"), HasSubstr("unit: \"°C\""));
}

TEST(ImportText, WhatIsNotATextGetsAClearWord) {
  const auto fault = [](const std::string& bytes) { return import_text("f", bytes).error(); };
  EXPECT_THAT(fault(""), HasSubstr("f: the file is empty"));
  EXPECT_THAT(fault(" \r\n \t "), HasSubstr("the file is empty"));
  EXPECT_THAT(fault(std::string("\x7F"
                                "ELF\x02\0\0\0\xFF",
                                9)),
              HasSubstr("a program, no list"));
  EXPECT_THAT(fault("%PDF-1.4\n\x01\xFF"), HasSubstr("a PDF"));
  EXPECT_THAT(fault(std::string("\xD0\xCF\x11\xE0\0\0", 6)), HasSubstr("an old Excel file"));
  EXPECT_THAT(fault(std::string(100, '\0')), HasSubstr("binary, no text"));
  EXPECT_THAT(fault("Register;Name;Type\n40001;a;UINT16\n40002;b\x0B;UINT16\n"),
              HasSubstr("line 3: the character 0x0B"));
  EXPECT_TRUE(import_text("f", "Register;Name;Type\r\n40001;a;UINT16\r\n\x1A"));
  EXPECT_THAT(fault("Dear colleague,\nthe meter is broken.\n"), HasSubstr("of no format"));
}

TEST(ImportTable, CellsHoldQuotesSeparatorsAndLineEnds) {
  const auto table = read_table("a,\"b \"\"c\"\", d\",e\n,,\n\"two\nlines\",x,,,\n");
  ASSERT_TRUE(table);
  ASSERT_EQ(table->rows.size(), 2u);
  EXPECT_THAT(table->rows[0].cells, testing::ElementsAre("a", "b \"c\", d", "e"));
  EXPECT_THAT(table->rows[1].cells, testing::ElementsAre("two\nlines", "x"));
  EXPECT_EQ(table->rows[1].line, 3u);
  EXPECT_THAT(read_table("a,b\nc,\"d\n").error(), HasSubstr("line 2: a quoted cell has no end"));
}

TEST(ImportAddress, IsUnderstoodInManyForms) {
  const auto text = [](std::string_view written) {
    const auto reference = reference_from(written);
    if (!reference) return "fault: " + reference.error();
    return reference->area ? address_text(*reference->area, reference->first, reference->bit)
                           : "bare:" + std::to_string(reference->first);
  };
  EXPECT_EQ(text("40001"), "holding:0");
  EXPECT_EQ(text("465536"), "holding:65535");
  EXPECT_EQ(text("4x0101"), "holding:100");
  EXPECT_EQ(text("4:101"), "holding:100");
  EXPECT_EQ(text("30007.3"), "input-register:6.3");
  EXPECT_EQ(text("%MW70"), "holding:70");
  EXPECT_EQ(text("HR 12"), "holding:12");
  EXPECT_EQ(text("0x1F"), "bare:31");
  EXPECT_EQ(text("1234h"), "bare:4660");
  EXPECT_THAT(text("40000"), HasSubstr("count from 1"));
  EXPECT_THAT(text("470000"), HasSubstr("no number from 1 to 65536"));
  EXPECT_THAT(text("40001.16"), HasSubstr("bit '16'"));
}

TEST(ImportType, HasManyNames) {
  const auto type = [](std::string_view name) {
    const auto found = type_by_name(name);
    return found ? std::string(to_text(found->type)) : "unknown";
  };
  EXPECT_EQ(type("Float"), "float32");
  EXPECT_EQ(type("32-bit unsigned integer"), "uint32");
  EXPECT_EQ(type("REAL"), "float32");
  EXPECT_EQ(type("S16"), "int16");
  EXPECT_EQ(type("unsigned long"), "uint32");
  EXPECT_EQ(type("STRING[16]"), "string");
  EXPECT_EQ(type("complex"), "unknown");
  EXPECT_EQ(type_by_name("FLOAT32_LE")->word_order, WordOrder::kLittleEndian);
  EXPECT_EQ(type_by_name("UINT8H")->byte, 1);
}

TEST(ImportKepware, TagsBecomeChannels) {
  const auto outcome =
      imported("press.csv", kKepware +
                                "Speed,400101,Word,1,RO,500,Linear,0,4095,0,1500,Double,0,0,rpm,,\n"
                                "Energy,400110,Float,1,RO,1000,,,,,,,,,kWh,,\n"
                                "Fault,40120.5,Boolean,1,RO,100,,,,,,,,,,,\n"
                                "Hex,H4000A1,DWord,1,R/W,1000,,,,,,,,,,,1\n"
                                "Label,400300.20L,String,1,RO,1000,,,,,,,,,,,\n"
                                "Run,000001,Default,1,R/W,100,,,,,,,,,,,\n");
  EXPECT_EQ(outcome.count(Fate::kMoved), 6u);
  EXPECT_EQ(channel_line(outcome, "Speed"),
            "{ name: Speed, at: \"holding:100\", type: uint16, scale: 0.3663003663003663, unit: "
            "rpm, refresh: 500ms }");
  EXPECT_THAT(outcome.files[0].text, HasSubstr("word-order: little-endian"));
  expect_channels(outcome,
                  {"Fault -> at: \"holding:119.5\", type: bool",
                   "Hex -> at: \"holding:160\", type: uint32, scale: -1",
                   "Label -> string(20), byte-order: little-endian", "Run -> access: read-write"});
}

TEST(ImportKepware, ArraysBecomeAChannelForEachElement) {
  const auto outcome =
      imported("a.csv", kKepware + "Limit,400201[2][2],Float Array,1,R/W,1000,,,,,,,,,,,\n");
  EXPECT_EQ(outcome.count(Fate::kChanged), 4u);
  EXPECT_THAT(channel_line(outcome, "Limit-3"), HasSubstr("at: \"holding:206\""));
}

TEST(ImportKepware, WhatCannotBeMovedHasItsReason) {
  const auto outcome =
      imported("a.csv", kKepware +
                            "Flow,300010,Word,1,RO,100,Square Root,0,4095,0,100,Float,0,0,,,\n"
                            "Day,400001,Date,1,RO,100,,,,,,,,,,,\n"
                            "Far,470000,Word,1,RO,100,,,,,,,,,,,\n"
                            "Good,400001,Word,1,RO,100,Linear,0,100,0,10,Float,1,1,,,\n");
  expect_fates(outcome, {"Flow -> no: square-root scaling", "Day -> no: dates",
                         "Far -> no number from 1 to 65536", "Good -> not clamped"});
}

TEST(ImportKepware, AddressesOfS7200HaveTheWidthOfTheirType) {
  const auto outcome = imported("press.csv",
                                kKepware +
                                    "Level,V00100,Word,1,RO,500,,,,,,,,,,,\n"
                                    "Flow,V00104,Float,1,R/W,500,,,,,,,,,,,\n"
                                    "Mode,M00001,Byte,1,RO,500,,,,,,,,,,,\n"
                                    "Run,Q00000.03,Boolean,1,RO,500,,,,,,,,,,,\n"
                                    "Input,AI00004,Short,1,RO,500,,,,,,,,,,,\n"
                                    "Timer,T037,Long,1,RO,500,,,,,,,,,,,\n"
                                    "List,V00200[3],DWord Array,1,RO,500,,,,,,,,,,,\n"
                                    "High,V00100.12,Boolean,1,RO,500,,,,,,,,,,,\n"
                                    "Done,T037,Boolean,1,RO,500,,,,,,,,,,,\n"
                                    "Text,V00300.20,String,1,RO,500,,,,,,,,,,,\n"
                                    "Some,V00100,Default,1,RO,500,,,,,,,,,,,\n",
                                {.protocol = "s7-ppi"});
  expect_channels(outcome, {"Level -> at: VW100, type: uint16", "Flow -> at: VD104, type: float32",
                            "Mode -> at: MB1, type: uint8", "Run -> at: Q0.3, type: bool",
                            "Input -> at: AIW4, type: int16", "Timer -> at: T37, type: int32",
                            "List-2 -> at: VD208, type: uint32"});
  expect_fates(outcome, {"High -> no: bit 12 of a word", "Done -> no: the status bit",
                         "Text -> no: a text", "Some -> no: data type 'Default'"});
}

TEST(ImportKepware, AddressesOfHostLinkAndFxAreTheSameButForTimersAndTexts) {
  const std::string omron = kKepware +
                            "Level,DM0100,Short,1,RO,500,,,,,,,,,,,\n"
                            "Alarm,IR010.05,Boolean,1,RO,500,,,,,,,,,,,\n"
                            "Run,AR003.15,Default,1,RO,500,,,,,,,,,,,\n"
                            "Count,TC005,BCD,1,RO,500,,,,,,,,,,,\n"
                            "Done,TS005,Boolean,1,RO,500,,,,,,,,,,,\n"
                            "Label,DM0200.20H,String,1,RO,500,,,,,,,,,,,\n"
                            "Wide,DM0300.10D,String,1,RO,500,,,,,,,,,,,\n"
                            "Total,HR10[2],Long Array,1,RO,500,,,,,,,,,,,\n";
  const auto outcome = imported("plc.csv", omron, {.protocol = "omron-hostlink"});
  expect_channels(outcome,
                  {"Level -> at: DM0100, type: int16", "Alarm -> at: IR010.05, type: bool",
                   "Run -> at: AR003.15, type: bool", "Count -> at: T005, type: bcd16",
                   "Done -> at: TF005, type: bool", "Label -> at: DM0200, type: string(20)"});
  EXPECT_THAT(fate_of(outcome, "Wide"), HasSubstr("no: a text with one character in a word"));
  EXPECT_THAT(channel_line(outcome, "Total-1"), HasSubstr("at: HR12, type: int32"));
  const auto fx = imported("fx.csv",
                           kKepware +
                               "Speed,D0100,Float,1,RO,500,,,,,,,,,,,\n"
                               "Input,X017,Boolean,1,RO,500,,,,,,,,,,,\n"
                               "Limits,D0200[2],Word Array,1,RO,500,,,,,,,,,,,\n"
                               "Text,D0300.10,String,1,RO,500,,,,,,,,,,,\n",
                           {.protocol = "mitsubishi-fx"});
  expect_channels(fx, {"Speed -> at: D0100, type: float32", "Input -> at: X017, type: bool",
                       "Limits-1 -> at: D201, type: uint16"});
  EXPECT_THAT(fate_of(fx, "Text"), HasSubstr("no: a text"));
}

TEST(ImportList, WhatIsNotAnAddressIsRefused) {
  const auto outcome = imported("meter.csv",
                                "Address;Name;Type\n"
                                "7;good;UINT16\n"
                                "99999999999999999999;big;UINT16\n"
                                "-5;less;UINT16\n"
                                "1e3;power;UINT16\n"
                                "n/a;none;UINT16\n"
                                "70000;far;UINT16\n");
  EXPECT_THAT(channel_line(outcome, "good"), HasSubstr("at: \"holding:7\""));
  for (const char* name : {"big", "less", "power", "none", "far"})
    EXPECT_THAT(fate_of(outcome, name), HasSubstr("is no ")) << name;
  EXPECT_EQ(outcome.count(Fate::kRefused), 5u);
}

TEST(ImportList, DecimalCommasAndColumnsInAnyOrder) {
  const auto outcome = imported("meter.csv",
                                "Einheit;Faktor;REGISTER;Bezeichnung;Datentyp;Hersteller;;\r\n"
                                "V;0,1;40001;Spannung L1;UINT16;x;;\r\n"
                                "kWh;1/1000;40003;Zähler;UINT32;x;;\r\n"
                                ";;;;;;;\r\n");
  expect_channels(outcome, {"Spannung-L1 -> at: \"holding:0\", type: uint16, scale: 0.1, unit: V",
                            "Zaehler -> scale: 0.001"});
  EXPECT_THAT(outcome.notes, testing::Contains(HasSubstr("column 'Hersteller' is not used")));
}

TEST(ImportList, FunctionCodesDecideWhereDigitsAreAmbiguous) {
  // Here 32016 is a holding register of an inverter, not a reference to an input register.
  const auto outcome = imported("inverter.csv",
                                "Signal Name,Address,Type,Gain,Unit,Function\n"
                                "PV1 voltage,32016,I16,10,V,03\n"
                                "Model,30000,STRING[30],,,03\n");
  EXPECT_EQ(channel_line(outcome, "PV1-voltage"),
            "{ name: PV1-voltage, at: \"holding:32016\", type: int16, scale: 0.1, unit: V }");
  EXPECT_THAT(channel_line(outcome, "Model"), HasSubstr("at: \"holding:30000\", type: string(30)"));
}

TEST(ImportList, AnAddressWithADecimalIsABitOnlyWhereTheTypeIsOne) {
  const auto outcome = imported("meter.csv",
                                "Register,Name,Type\n40001.0,power,UINT16\n40002.0,ready,Bool\n"
                                "40003.4,odd,UINT32\n40004.12,alarm,\n");
  expect_channels(outcome, {"power -> at: \"holding:0\", type: uint16",
                            "ready -> at: \"holding:1.0\", type: bool"});
  EXPECT_THAT(fate_of(outcome, "odd"), HasSubstr("no: data type 'UINT32' at a single bit"));
  EXPECT_THAT(channel_line(outcome, "alarm"), HasSubstr("at: \"holding:3.12\", type: bool"));
}

TEST(ImportedNames, AreAllowedUniqueAndNotTooLong) {
  const std::string long_name(100, 'x');
  const auto outcome = imported("meter.csv",
                                "Address,Name,Type\n1,Power (kW),U16\n2,Power "
                                "(kW),U16\n3," +
                                    long_name + ",U16\n4,мощность,U16\n");
  EXPECT_FALSE(channel_line(outcome, "Power-kW").empty());
  EXPECT_FALSE(channel_line(outcome, "Power-kW-2").empty());
  EXPECT_FALSE(channel_line(outcome, std::string(64, 'x')).empty());
  EXPECT_THAT(channel_line(outcome, "holding-4"), HasSubstr("description: \"мощность\""));
}

TEST(ImportedConfiguration, IsStretchedWhereTheLineCouldNeverCarryIt) {
  std::string list = "Address,Name,Type,Refresh ms\n";
  for (int i = 0; i < 2000; ++i)
    list += std::to_string(i * 30) + ",p" + std::to_string(i) + ",U16,10\n";
  ImportOptions options;
  options.port = {.serial = "/dev/ttyS0", .line = {.baud = 1200}};
  const auto outcome = imported("meter.csv", list, options);
  EXPECT_THAT(outcome.notes, testing::Contains(HasSubstr("far too slow")));
}

TEST(ImportedConfiguration, OfTooManyValuesGetsAClearWord) {
  std::string list = "Address,Name,Type\n";
  for (int i = 0; i <= 100'000; ++i) list += std::to_string(i % 60'000) + ",p,U16\n";
  const auto outcome = import_text("meter.csv", list);
  ASSERT_FALSE(outcome);
  EXPECT_EQ(outcome.error(),
            "100001 values; a bridge has at most 100000 channels: split the lists");
  // A few rows may expand to as many points.
  const auto arrays = import_text(
      "a.csv", kKepware + [] {
        std::string rows;
        for (int i = 0; i < 200; ++i)
          rows += "T" + std::to_string(i) + ",400001[1000],Word Array,1,RO,1000,,,,,,,,,,,\n";
        return rows;
      }());
  ASSERT_FALSE(arrays);
  EXPECT_THAT(arrays.error(), HasSubstr("split the lists"));
}

TEST(ImportedTemplate, IsCheckedAndWrittenForEachDevice) {
  ImportOptions options;
  options.as_template = true;
  const auto outcome = imported("meter.csv", "Address,Name,Type\n0,power,U16\n", options);
  ASSERT_EQ(outcome.files.size(), 1u);
  EXPECT_EQ(outcome.files[0].name, "devices/meter.yaml");
  EXPECT_THAT(outcome.files[0].text,
              HasSubstr("protocols: [modbus-rtu, modbus-ascii, modbus-tcp]\nchannels:\n"
                        "  - { name: power, at: \"holding:0\", type: uint16 }\n"));
}

}  // namespace
}  // namespace fieldcast::importing
